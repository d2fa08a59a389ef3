// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/ratings_json.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json intervalJson(const Expected<Interval>& i) {
  if (!i) return {{"value", nullptr}, {"reason", i.reason()}};
  return {{"lower", i->lower}, {"upper", i->upper}, {"level", i->level}, {"method", i->method}};
}

template <class T>
Json estimateJson(const Expected<T>& answer) {
  if (!answer) return {{"value", nullptr}, {"reason", answer.reason()}};
  return {{"value", answer->value}, {"interval", intervalJson(answer->interval)}};
}

Json itemJson(const FormReport& report, const ItemReport& item) {
  Json groups = Json::array();
  for (std::size_t g = 0; g < report.groups.size(); ++g) {
    const ItemSummary& s = item.groups[g];
    Json counts = Json::object();
    for (const auto& [score, count] : s.counts) counts[std::to_string(score)] = count;
    groups.push_back({{"group", report.groups[g]},
                      {"primary", !item.primaryGroup.empty() && report.groups[g] == item.primaryGroup},
                      {"n", s.n},
                      {"blank", s.blank},
                      {"median", orNull(s.median)},
                      {"lower_quartile", orNull(s.lowerQuartile)},
                      {"upper_quartile", orNull(s.upperQuartile)},
                      {"mean", orNull(s.mean)},
                      {"published_mean", orNull(item.published[g])},
                      {"counts", counts}});
  }
  return {{"item", item.key}, {"text", item.text}, {"groups", groups}};
}

}  // namespace

nlohmann::ordered_json ratingsJson(const std::vector<FormReport>& reports) {
  Json all = Json::array();
  for (const FormReport& r : reports) {
    Json j{{"form", r.name},     {"version", r.version},       {"title", r.title},
           {"source", r.source}, {"filled", r.filled},         {"left_out", r.leftOut},
           {"groups", r.groups}, {"incomplete", r.incomplete}, {"items", Json::array()}};
    for (const ItemReport& item : r.items) j["items"].push_back(itemJson(r, item));
    j["scales"] = Json::array();
    for (const ScaleReport& s : r.scales) {
      Json groups = Json::array();
      for (std::size_t g = 0; g < r.groups.size(); ++g) {
        const ItemSummary& of = s.groups[g];
        groups.push_back({{"group", r.groups[g]},
                          {"n", of.n},
                          {"blank", of.blank},
                          {"median", orNull(of.median)},
                          {"lower_quartile", orNull(of.lowerQuartile)},
                          {"upper_quartile", orNull(of.upperQuartile)},
                          {"mean", orNull(of.mean)},
                          {"mean_of_an_item",
                           orNull(of.mean ? std::optional(*of.mean / static_cast<double>(s.items)) : std::nullopt)}});
      }
      j["scales"].push_back({{"scale", s.name}, {"items", s.items}, {"groups", groups}});
    }
    j["consistency"] = Json::array();
    for (const SectionConsistency& s : r.sections)
      j["consistency"].push_back({{"section", s.section}, {"n", s.n}, {"alpha", estimateJson(s.alpha)}});
    j["agreement"] = Json::array();
    for (const Agreement& a : r.agreement) {
      j["agreement"].push_back({{"figure", a.figure},
                                {"attempts", a.attempts},
                                {"raters", a.raters},
                                {"icc_2_1", estimateJson(a.single)},
                                {"icc_2_k", estimateJson(a.average)}});
    }
    all.push_back(j);
  }
  return all;
}

}  // namespace calot::analytics
