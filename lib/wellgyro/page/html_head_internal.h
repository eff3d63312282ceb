#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/result/json_table_internal.h"

namespace wellgyro {

/// The begin of a page, to that of its body: `style`, and a policy under which only `scripts` run
/// and only `connect` (a source of CSP, as 'none') is asked for more.
std::string HeadElement(std::string_view title, std::string_view style,
                        const std::vector<std::string_view>& scripts, std::string_view connect);

/// JSON as it may stand within a script element: no sign in it can end the element.
std::string InScript(const Json& json);

/// The licence of D3, then `scripts`, D3 first, and the end of the page.
std::string TailElements(const std::vector<std::string_view>& scripts);

}  // namespace wellgyro
