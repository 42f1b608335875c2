#include "postproc/mirror_plane.h"

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::postproc {

MirrorPlane mirror_plane_from(const std::string& text) {
    MirrorPlane plane;
    if (text.empty() || text == "none") {
        return plane;
    }
    const auto equals = text.find('=');
    const std::string axis = core::lower_case(core::trimmed(std::string_view(text).substr(0, equals)));
    if (axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z') {
        throw core::UsageError("usage", "'" + text + "' is no symmetry plane", {}, "give its normal axis: --symmetry y, or --symmetry y=0.1");
    }
    plane.axis = axis[0] - 'x';
    if (equals != std::string::npos) {
        plane.at = core::parse_in(text.substr(equals + 1), "m");
    }
    return plane;
}

}  // namespace underbody::postproc
