// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mapbuilder/laboratory/html_report.h"
#include "mapbuilder/laboratory/result_table.h"
#include "mapbuilder/plot/svg_plot.h"

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::Not;

ResultTable SmallTable() {
  ResultTable table;
  table.title = "Small";
  table.columns = {{"name", "name"}, {"length_mm", "length mm", 2}};
  table.rows = {{std::string("a<b"), 1.234}, {std::string("c"), {}}, {std::string("d")}};
  return table;
}

TEST(ResultTable, TextAlignsAndMarksWhatIsNotKnown) {
  EXPECT_EQ(ToText(SmallTable()),
            "Small\n\nname  length mm  \na<b        1.23  \nc             -  \nd             -  \n");
}

TEST(ResultTable, JsonHasNumbersAndNulls) {
  const nlohmann::ordered_json json = ToJson(SmallTable());
  EXPECT_EQ(json["rows"][0]["name"], "a<b");
  EXPECT_EQ(json["rows"][0]["length_mm"], 1.234);
  EXPECT_TRUE(json["rows"][1]["length_mm"].is_null());
  EXPECT_TRUE(json["rows"][2]["length_mm"].is_null());
}

TEST(ResultTable, NotANumberIsNothing) { EXPECT_EQ(CellText(NumberCell(std::nan("")), 1), "-"); }

TEST(SvgPlot, BarsAreAsLongAsTheirValues) {
  const std::string svg = BarChart({{"one", 50.0, "g", ""}, {"two", 100.0, "g", ""}}, {100.0, 0, " %", {}});
  EXPECT_THAT(svg, HasSubstr("width='215'"));
  EXPECT_THAT(svg, HasSubstr("width='430'"));
  EXPECT_THAT(svg, HasSubstr(">50 %<"));
}

TEST(SvgPlot, DotsThatHaveNoPlaceAreLeftOut) {
  const std::string svg =
      ScatterPlot({{1.0, 2.0, "kept", "g"}, {1.0, 0.0, "dropped", "g"}, {1.0, std::nan(""), "dropped", "g"}}, {});
  EXPECT_THAT(svg, HasSubstr("kept"));
  EXPECT_THAT(svg, Not(HasSubstr("dropped")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(ScatterPlot({}, {}), HasSubstr("nothing"));
}

TEST(HtmlReport, EscapesAndNeedsNothingElse) {
  LaboratoryReport report;
  report.title = "Title & more";
  report.tables = {SmallTable()};
  const std::string html = ToHtml(report);
  EXPECT_THAT(html, HasSubstr("Title &amp; more"));
  EXPECT_THAT(html, HasSubstr("a&lt;b"));
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace floorloc
