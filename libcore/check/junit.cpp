#include <string>

#include "libcore/base/text.hpp"
#include "libcore/check/report.hpp"

namespace hapgrid {

namespace {

/// For text and attributes. XML 1.0 has no control characters but tab and the ends of lines, not
/// even escaped; printable_text() leaves no others.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : printable_text(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\n':
        out += "&#10;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string test_case(const Check& check) {
  const bool is_fine = check.is_note || check.verdict() == "ok";
  const std::string details = escaped(checks_text({check}, Details::kAll));
  const std::string message = std::to_string(check.found.offenders) + " of " +
                              std::to_string(check.found.counted) + " " + check.unit + ": " +
                              (check.not_proved.empty() ? check.meaning : check.not_proved);
  std::string xml = "  <testcase classname=\"verify\" name=\"" + escaped(check.name) + "\">\n";
  if (is_fine)
    xml += "    <system-out>" + details + "</system-out>\n";
  else
    xml += "    <failure type=\"" + check.verdict() + "\" message=\"" + escaped(message) + "\">" +
           details + "</failure>\n";
  return xml + "  </testcase>\n";
}

}  // namespace

std::string report_junit(const ReportedGrid& grid, const std::vector<Check>& checks) {
  std::string cases;
  std::size_t failures = 0;
  for (const Check& check : checks) {
    cases += test_case(check);
    failures += !is_fine({check});
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"" +
         escaped("verify " + grid.spec.model) + "\" tests=\"" + std::to_string(checks.size()) +
         "\" failures=\"" + std::to_string(failures) + "\">\n" + cases + "</testsuite>\n";
}

}  // namespace hapgrid
