#include "cases/case_loads.h"

#include <algorithm>
#include <cmath>

namespace underbody::cases {

postproc::ReadOptions read_options(const Case& entry) {
    postproc::ReadOptions options;
    options.length_unit = entry.length_unit;
    options.units = entry.units;
    return options;
}

postproc::LoadsOptions loads_options(const Study& study, const Case& entry) {
    postproc::LoadsOptions options;
    options.zones = entry.zones;
    options.forward = postproc::axis_from(study.forward);
    options.up = postproc::axis_from(study.up);
    options.symmetry = study.symmetry;
    options.reference = study.moments_about;
    options.references.density = study.density_of(entry);
    options.references.length = study.reference.number("length");
    options.references.width = study.reference.number("width");
    options.references.height = study.reference.number("height");
    options.references.speed = study.speed_of(entry);
    return options;
}

std::map<std::string, double> known_errors(const Study& study, const StudyResults& results,
                                           const std::string& quantity) {
    std::map<std::string, double> errors;
    const auto take = [&](const core::Table& table) {
        const auto* sigma = table.find(quantity + "_sigma");
        const auto* names = table.find("case");
        for (std::size_t row = 0; sigma != nullptr && names != nullptr && row < table.rows(); ++row) {
            if (std::isfinite(sigma->numbers[row])) {
                double& error = errors[names->text[row]];
                error = std::max(error, sigma->numbers[row]);
            }
        }
    };
    take(results.loads);
    for (const auto& spec : study.tables) {
        if (spec.quantity != quantity || !has_loads(spec, results)) {
            continue;
        }
        try {
            take(table_points(spec, results));
        } catch (const core::InputError&) {  // its own step says why
        }
    }
    return errors;
}

}  // namespace underbody::cases
