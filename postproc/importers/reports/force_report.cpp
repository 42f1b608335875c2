#include "postproc/importers/reports/force_report.h"

namespace underbody::postproc {

const ReportedForce* ForceReport::net() const {
    for (const auto& row : rows) {
        if (row.zone == "Net") {
            return &row;
        }
    }
    return nullptr;
}

}  // namespace underbody::postproc
