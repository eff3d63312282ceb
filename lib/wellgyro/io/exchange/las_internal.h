#pragma once

#include <array>
#include <string>
#include <string_view>

#include "wellgyro/record/survey_head.h"

/// CWLS LAS 2.0 (1992, with the updates of 2014 and 2017).
namespace wellgyro::las {

/// Well-information mnemonics and the names they carry.
struct WellKey {
  std::string_view mnemonic, text;
  std::string SurveyIdentity::*member;
};
inline constexpr std::array kWellKeys{
    WellKey{"COMP", "COMPANY", &SurveyIdentity::operator_name},
    WellKey{"WELL", "WELL", &SurveyIdentity::well},
    WellKey{"FLD", "FIELD", &SurveyIdentity::field},
    WellKey{"LOC", "LOCATION", &SurveyIdentity::structure},
    WellKey{"PROV", "PROVINCE", &SurveyIdentity::region},
    WellKey{"CTRY", "COUNTRY", &SurveyIdentity::country},
    WellKey{"SRVC", "SERVICE COMPANY", &SurveyIdentity::contractor},
    WellKey{"DATE", "SURVEY DATE", &SurveyIdentity::begin},
    WellKey{"UWI", "UNIQUE WELL ID", &SurveyIdentity::uwi},
};

/// Parameters after the Inclinometry set of LAS 3.0, and the head's keys that they stand for.
struct ParameterKey {
  std::string_view mnemonic, unit, key, text;
};
inline constexpr std::array kParameters{
    ParameterKey{"I_AT", "", "north_reference", "AZIMUTH NORTH TYPE"},
    ParameterKey{"I_DC", "DEG", "declination_deg", "MAGNETIC DECLINATION"},
    ParameterKey{"I_DCSRC", "", "declination_source", "DECLINATION MODEL"},
    ParameterKey{"I_DCDATE", "", "declination_date", "DECLINATION DATE"},
    ParameterKey{"I_GC", "DEG", "grid_convergence_deg", "GRID CONVERGENCE"},
    ParameterKey{"I_GSF", "", "grid_scale", "GRID SCALE FACTOR"},
    ParameterKey{"I_GD", "", "datum", "DEPTH DATUM"},
    ParameterKey{"I_RF", "M", "datum_elevation_m", "DATUM ELEVATION"},
    ParameterKey{"I_VR", "", "vertical_reference", "VERTICAL REFERENCE"},
    ParameterKey{"I_CP", "", "method", "COMPUTE METHOD"},
    ParameterKey{"I_CS", "", "crs", "COORDINATE SYSTEM"},
    ParameterKey{"I_VSAZ", "DEG", "section_azimuth_deg", "VERTICAL SECTION AZIMUTH"},
    ParameterKey{"I_TOOL", "", "tool", "SURVEY TOOL CLASS"},
    ParameterKey{"I_EM", "", "error_model", "TOOL ERROR MODEL"},
    ParameterKey{"I_DK", "", "depth_kind", "DEPTH KIND"},
    ParameterKey{"I_SURV", "", "survey", "SURVEY"},
    ParameterKey{"I_WB", "", "wellbore", "WELLBORE"},
    ParameterKey{"I_RIG", "", "rig", "RIG"},
    ParameterKey{"I_JOB", "", "job", "JOB"},
    ParameterKey{"I_END", "", "end", "END OF SURVEY"},
};

inline constexpr std::string_view kColonLetter = "\xEA\x9E\x89";
/// LAS 2.0 of 1992 forbids colons in data: they are written as the letter that looks like one,
/// U+A789, which reading turns back. Line breaks become blanks.
std::string DataText(std::string_view text);
std::string FromDataText(std::string_view data);

}  // namespace wellgyro::las
