// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/rater_page.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "analytics/report/report_document.h"
#include "recorder/base/files.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

/// "sha256-...", as a content security policy names what it lets run.
std::string policyDigest(std::string_view text) {
  return "sha256-" + recorder::base64(recorder::sha256(std::as_bytes(std::span(text))));
}

/// Data within a page: no "</script>" can end it early.
std::string dataOf(const RatingPage& page) {
  Json items = Json::array();
  for (const FormSection& section : page.form.sections) {
    for (const FormItem& item : section.items) {
      items.push_back({{"key", item.key}, {"text", item.text}, {"section", section.name}, {"anchors", item.anchors}});
    }
  }
  const Json data{{"pack", page.pack},        {"rater", page.rater},
                  {"least", page.form.least}, {"most", page.form.most},
                  {"words", page.form.words}, {"items", items},
                  {"films", page.films},      {"doublets", page.form.ofDoublets}};
  std::string text = data.dump(-1, ' ', true, Json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

constexpr const char* bodyOfPage = R"~(<header><div><h1>{title}</h1><p id="count" role="status"></p></div>
<button id="save" type="button">Save the answers</button></header>
<p id="message" role="alert" hidden></p>
<nav aria-label="Films"><ol id="list"></ol></nav>
<main><section aria-label="Film"><h2 id="heading" tabindex="-1"></h2><video id="film" controls preload="metadata"></video>
<p class="hint">Tab moves on, the arrow keys choose a score.{film}
Answers stay in this browser until they are saved.</p></section>
<form id="form" aria-labelledby="heading"><div id="items"></div>
<p class="step"><button id="previous" type="button">Previous</button> <button id="next" type="button">Next</button></p></form></main>
)~";

}  // namespace

std::string ratingPageHtml(const RatingPage& page) {
  const std::string style = ratingPageStyle(), script = ratingPageScript();
  std::string body = bodyOfPage;
  const auto put = [&](const std::string& place, const std::string& text) {
    body.replace(body.find(place), place.size(), text);
  };
  put("{title}", escaped(page.form.title));
  put("{film}", page.form.ofDoublets ? "" : " The space bar plays and pauses the film that has the focus.");
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src '{}'; style-src '{}'; "
      "media-src 'self' file:; img-src 'self' file:; form-action 'none'; base-uri 'none'\">\n"
      "<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n"
      "<style>{}</style></head>\n<body>{}<script type=\"application/json\" id=\"data\">{}</script>\n"
      "<script>{}</script></body></html>\n",
      policyDigest(script), policyDigest(style), escaped(page.form.title), style, body, dataOf(page), script);
}

}  // namespace calot::analytics
