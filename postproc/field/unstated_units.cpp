#include "postproc/field/unstated_units.h"

#include <algorithm>

#include "postproc/field/import_error.h"

namespace underbody::postproc {

std::vector<UnstatedUnit> unstated_units(const std::filesystem::path& path, ReadOptions options,
                                         core::Progress& progress) {
    options.surfaces_only = true;
    std::vector<UnstatedUnit> missing;
    constexpr std::size_t most = 100;  // an importer that asks again for what it was told must not go on for ever
    while (missing.size() < most) {
        try {
            const Field field = read_field(path, options, progress);
            const bool lengths = std::any_of(field.metadata.begin(), field.metadata.end(), [](const auto& one) {
                return one.first == "length unit" && one.second.starts_with("not stated");
            });
            if (lengths) {
                missing.push_back({"", "m", false});
            }
            return missing;
        } catch (const UnitMissing& error) {
            if (std::any_of(missing.begin(), missing.end(),
                            [&](const UnstatedUnit& one) { return one.variable == error.variable(); })) {
                throw;
            }
            missing.push_back({error.variable(), error.unit()});
            if (error.variable().empty()) {
                options.length_unit = error.unit();
            } else {
                options.units.emplace_back(error.variable(), error.unit());
            }
        }
    }
    return missing;
}

}  // namespace underbody::postproc
