#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/record/survey_head.h"

/// What WITSML wants of words: units, identifiers, times, methods.
namespace wellgyro::witsml {

/// Units of a survey's numbers, by the names of 1.4.1.1 or of 2.1.
class Units {
 public:
  Units(const SurveyHead& head, bool version_2) : head_(head), version_2_(version_2) {}

  std::string Name(Quantity quantity) const;
  std::string Text(Quantity quantity, double value) const;

 private:
  std::string Length(LengthUnit unit) const;
  std::string Curvature() const;

  const SurveyHead& head_;
  bool version_2_;
};

/// `given` if it is a UUID, else one that the same survey gets again: the head of a hash of what it
/// names.
std::string UuidOf(const std::string& given, std::string_view what, const SurveyHead& head);
/// Characters that 1.4.1.1 allows in names and identifiers, and in values of extensions; 2.1 in
/// values of extensions.
inline constexpr std::size_t kNameLength = 64, kValueLength = 4000, kValueLengthOf21 = 2000;
/// What stands in mandatory elements for which there is nothing to say.
inline constexpr std::string_view kUnknown = "unknown", kNoDate = "1970-01-01T00:00:00.000Z";
/// The first characters of UTF-8 text.
std::string Cut(const std::string& text, std::size_t characters);
/// Identifiers of 1.4.1.1 have no blanks and 64 characters at most. What must be changed for that,
/// or holds other than ASCII, ends in the head of its hash, so that different texts stay different.
std::string Uid(const std::string& text, std::string_view otherwise);
std::string Or(const std::string& text, std::string_view otherwise);
/// xsd:dateTime of a day or an instant; nothing when it is neither.
std::string DateTime(const std::string& text);
/// Of the schemas' list; nothing for another method, which goes as an extension.
std::string Method(const std::string& method);
/// Of the schemas' list; nothing for a tool that it lacks.
std::string ToolText(SurveyTool tool);

}  // namespace wellgyro::witsml
