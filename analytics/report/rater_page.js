// SPDX-License-Identifier: GPL-3.0-or-later
// The page in which a rater watches films and fills in a form for each (docs/how-to/ratings.md, "Blinded raters").
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const at = id => document.getElementById(id);
const place = "calot-answers " + data.pack + " " + data.rater;
const BLANK = "-";
const kind = data.doublets ? "Doublet" : "Film", ending = data.doublets ? ".png" : ".mp4";
if (data.doublets) {
  const picture = document.createElement("img");
  picture.id = "film";
  at("film").replaceWith(picture);
}
let answers = {}, shown = 0, saved = true;
for (const film of data.films) answers[film] = {};
try {
  const kept = JSON.parse(localStorage.getItem(place) || "{}");
  for (const film of data.films) for (const item of data.items) {
    const score = kept[film] && kept[film][item.key];
    if (typeof score === "string") answers[film][item.key] = score;
  }
} catch (e) { /* A browser that keeps nothing still rates. */ }

const given = film => data.items.filter(item => item.key in answers[film]).length;
const isWhole = film => given(film) === data.items.length;
function element(name, parent, text) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.append(made);
  return made;
}
function say(text, good) {
  at("message").textContent = text;
  at("message").hidden = !text;
  at("message").className = good ? "good" : "";
}
function count() {
  const whole = data.films.filter(isWhole).length;
  at("count").textContent = whole + " of " + data.films.length + " " + kind.toLowerCase() + "s rated";
  data.films.forEach((film, i) => {
    const button = at("list").children[i].firstChild, n = given(film);
    button.textContent = (i + 1) + (isWhole(film) ? " \u2713" : n > 0 ? " \u2026" : "");
    button.setAttribute("aria-label", kind + " " + (i + 1) + ", " +
      (isWhole(film) ? "rated" : n > 0 ? n + " of " + data.items.length + " items answered" : "not rated"));
    if (i === shown) button.setAttribute("aria-current", "true"); else button.removeAttribute("aria-current");
  });
  at("previous").disabled = shown === 0;
  at("next").disabled = shown === data.films.length - 1;
}
function choose(film, key, score) {
  answers[film][key] = score;
  saved = false;
  say("");
  try { localStorage.setItem(place, JSON.stringify(answers)); } catch (e) { /* as above */ }
  count();
}
function option(parent, film, item, score, words) {
  const label = element("label", parent), input = element("input", label);
  input.type = "radio";
  input.name = item.key;
  input.value = score;
  input.checked = answers[film][item.key] === score;
  input.addEventListener("change", () => choose(film, item.key, score));
  element("span", label, words);
  if (score === BLANK) label.className = "blank";
}
function show(number, move) {
  shown = number;
  say("");
  const film = data.films[number];
  at("heading").textContent = kind + " " + (number + 1) + " of " + data.films.length;
  at("film").src = "films/" + film + ending;
  at("film").setAttribute(data.doublets ? "alt" : "aria-label", kind + " " + (number + 1));
  at("items").replaceChildren();
  let section = "";
  for (const item of data.items) {
    if (item.section !== section && data.items.some(other => other.section !== item.section)) element("h3", at("items"), item.section);
    section = item.section;
    const set = element("fieldset", at("items"));
    element("legend", set, item.text);
    const scores = element("div", set);
    scores.className = "scores";
    for (let score = data.least; score <= data.most; ++score) {
      const word = data.words[score - data.least];
      option(scores, film, item, String(score), word ? score + " " + word : String(score));
    }
    option(scores, film, item, BLANK, "cannot judge");
    const anchors = item.anchors.map((text, i) => [data.least + i, text]).filter(pair => pair[1]);
    if (anchors.length > 0) {
      const list = element("ul", set);
      list.className = "anchors";
      for (const pair of anchors) element("li", list, pair[0] + ": " + pair[1]);
    }
  }
  count();
  if (move) { at("heading").focus(); window.scrollTo(0, 0); }
}
function save() {
  const open = data.films.findIndex(film => !isWhole(film));
  if (open >= 0) {
    show(open, true);
    say(kind + " " + (open + 1) + " is not rated: " + data.items.filter(item => !(item.key in answers[data.films[open]]))
      .map(item => item.text).join(", ") + ". Choose \u201ccannot judge\u201d where it is not shown.");
    return;
  }
  try {
    const file = { format: "calot-answers", formatVersion: 1, pack: data.pack, rater: data.rater,
      films: data.films.map(film => ({ film: film, scores: Object.fromEntries(data.items.map(item => [item.key, answers[film][item.key]])) })) };
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([JSON.stringify(file, null, 2) + "\n"], { type: "application/json" }));
    link.download = "answers-" + data.rater + ".json";
    link.click();
    saved = true;
    say("Saved as " + link.download + ". Send this file back as it is.", true);
  } catch (e) {
    say("This browser cannot save the answers (" + e.message + "). Open the page in a current Chromium or Firefox.");
  }
}
data.films.forEach((film, i) => {
  const button = element("button", element("li", at("list")));
  button.type = "button";
  button.addEventListener("click", () => show(i, true));
});
at("previous").addEventListener("click", () => show(shown - 1, true));
at("next").addEventListener("click", () => show(shown + 1, true));
at("save").addEventListener("click", save);
at("form").addEventListener("submit", event => event.preventDefault());
at("film").addEventListener("error", () => say("films/" + data.films[shown] + ending + " cannot be shown. Unpack the whole folder, and open the page from there."));
window.addEventListener("beforeunload", event => { if (!saved) event.preventDefault(); });
const first = data.films.findIndex(film => !isWhole(film));
show(first < 0 ? 0 : first, false);
