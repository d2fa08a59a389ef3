// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/rating_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::ObjectRule;
using recorder::shown;

constexpr std::size_t maxFormBytes = 1U << 20U;
constexpr std::size_t maxSections = 20, maxItems = 60;

const ObjectRule formRule{"",
                          {{"format"},
                           {"formatVersion", true, 1, 1},
                           {"name"},
                           {"version", true, 1, 1000000},
                           {"title"},
                           {"source"},
                           {"about"},
                           {"scale"},
                           {"sections"},
                           {"subscales", false}}};
const ObjectRule scaleRule{"scale", {{"least", true, 0, 1}, {"most", true, 1, 100}, {"words", false}}};
const ObjectRule sectionRule{"section", {{"name"}, {"items"}}};
const ObjectRule itemRule{"item",
                          {{"key"}, {"text"}, {"primaryGroup", false}, {"anchors", false}, {"published", false}}};
const ObjectRule subscaleRule{"subscale", {{"name"}, {"items"}}};
const ObjectRule publishedRule{"published", {{"expert", true, 0, 100}, {"novice", true, 0, 100}}};

std::vector<std::string> wordsAt(const JsonPlace& place, const RatingForm& form) {
  const std::size_t scores = static_cast<std::size_t>(form.most) - static_cast<std::size_t>(form.least) + 1;
  std::vector<std::string> words;
  for (const JsonPlace& word : place.list(scores, scores)) words.push_back(word.text(maxText));
  return words;
}

FormItem itemAt(const RatingForm& form, const JsonPlace& place) {
  const JsonObject o = place.object(itemRule);
  FormItem item;
  item.key = plainName(o.at("key"));
  o.read("text", item.text, maxText);
  o.read("primaryGroup", item.primaryGroup, maxName);
  if (o.has("anchors")) item.anchors = wordsAt(o.at("anchors"), form);
  if (o.has("published")) {
    const JsonObject published = o.at("published").object(publishedRule);
    for (const char* group : {"expert", "novice"}) published.read(group, item.published[group]);
  }
  return item;
}

}  // namespace

std::vector<FormItem> RatingForm::items() const {
  std::vector<FormItem> all;
  for (const FormSection& section : sections) all.insert(all.end(), section.items.begin(), section.items.end());
  return all;
}

const std::vector<ObjectRule>& ratingFormRules() {
  static const std::vector<ObjectRule> rules{formRule, scaleRule, sectionRule, itemRule, subscaleRule, publishedRule};
  return rules;
}

RatingForm readRatingForm(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseRatingForm(recorder::readFileBytes(file, name, maxFormBytes), name);
}

RatingForm parseRatingForm(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json json = recorder::parseStrictJson(bytes, file);
  const JsonObject o = JsonPlace(json, file).object(formRule);
  RatingForm form;
  readHead(o, "calot-form", bytes, file, form);
  o.read("source", form.source, maxText);
  form.ofAttempts = o.at("about").word<bool>({{"attempt", true}, {"simulator", false}});
  const JsonObject scale = o.at("scale").object(scaleRule);
  std::uint32_t least = 1, most = 5;
  scale.read("least", least);
  scale.read("most", most);
  if (least >= most) scale.fail("\"least\" is not below \"most\"");
  form.least = static_cast<int>(least);
  form.most = static_cast<int>(most);
  if (scale.has("words")) form.words = wordsAt(scale.at("words"), form);
  std::set<std::string> keys;
  for (const JsonPlace& place : o.at("sections").list(1, maxSections)) {
    const JsonObject part = place.object(sectionRule);
    FormSection section;
    part.read("name", section.name, maxText);
    for (const JsonPlace& item : part.at("items").list(1, maxItems)) {
      section.items.push_back(itemAt(form, item));
      if (!keys.insert(section.items.back().key).second) item.fail("an item of this key stands above already");
    }
    form.sections.push_back(section);
  }
  if (o.has("subscales")) {
    std::set<std::string> names;
    for (const JsonPlace& place : o.at("subscales").list(1, maxSections)) {
      const JsonObject part = place.object(subscaleRule);
      FormSubscale subscale;
      part.read("name", subscale.name, maxText);
      if (!names.insert(subscale.name).second) part.fail("a subscale of this name stands above already");
      std::set<std::string> seen;
      for (const JsonPlace& item : part.at("items").list(1, maxItems)) {
        subscale.items.push_back(item.text(maxName));
        if (keys.count(subscale.items.back()) == 0) item.fail("no item of the form has this key");
        if (!seen.insert(subscale.items.back()).second) item.fail("named twice");
      }
      form.subscales.push_back(std::move(subscale));
    }
  }
  return form;
}

std::map<std::string, int> answersOf(const RatingForm& form,
                                     const std::vector<std::pair<std::string, std::string>>& given) {
  const std::vector<FormItem> items = form.items();
  std::map<std::string, int> answers;
  std::set<std::string> seen;
  const auto fail = [&](const std::string& key, const std::string& what) {
    throw Error(ErrorKind::invalid, fmt::format("form {}: item \"{}\": {}", form.name, shown(key), what));
  };
  for (const auto& [key, score] : given) {
    if (std::none_of(items.begin(), items.end(), [&k = key](const FormItem& item) { return item.key == k; })) {
      std::string known;
      for (const FormItem& item : items) known += (known.empty() ? "" : ", ") + item.key;
      fail(key, "the form has no such item; it has " + known);
    }
    if (!seen.insert(key).second) fail(key, "answered twice");
    if (score == "-") continue;
    std::string fault;
    const long long value = recorder::readWholeNumber(score, fault);
    if (!fault.empty() || value < form.least || value > form.most)
      fail(key, fmt::format("\"{}\" is no whole number from {} to {} (- where it was left blank)", shown(score),
                            form.least, form.most));
    answers[key] = static_cast<int>(value);
  }
  for (const FormItem& item : items) {
    if (seen.count(item.key) == 0) fail(item.key, "not answered (- where it was left blank)");
  }
  if (answers.empty()) throw Error(ErrorKind::invalid, fmt::format("form {}: every item was left blank", form.name));
  return answers;
}

}  // namespace calot::analytics
