// Where D3 was not there when the package was built.
#include <stdexcept>

#include "binding.h"

namespace wellgyro::python {

std::string ReportHtml(const std::string&, bool, bool) {
  throw std::runtime_error(
      "report: this package was built without D3; install it (Debian's node-d3) and build again");
}

}  // namespace wellgyro::python
