// Libraries speak of options by their names: "leave option 'symmetry' away". On the command line these are flags.
#pragma once

#include <string>

namespace underbody::studio {

/// "option 'symmetry y=0'" as "--symmetry y=0", wherever it stands; a value that a shell would take apart is in
/// quotation marks.
std::string with_flags(const std::string& text);

}  // namespace underbody::studio
