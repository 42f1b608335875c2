#include "postproc/importers/fluent_variables.h"

#include <array>
#include <utility>

namespace underbody::postproc {

namespace {

constexpr std::array<std::pair<int, const char*>, 35> numbers = {{
    {1, "SV_P"},
    {2, "SV_MOMENTUM"},
    {3, "SV_T"},
    {4, "SV_H"},
    {5, "SV_K"},
    {6, "SV_D"},
    {7, "SV_Y"},
    {8, "SV_G"},
    {15, "SV_BF"},
    {18, "SV_FLUX"},
    {19, "SV_WALL_SHEAR"},
    {20, "SV_HEAT_FLUX"},
    {21, "SV_RAD_HEAT_FLUX"},
    {35, "SV_WALL_YPLUS"},
    {36, "SV_WALL_YPLUS_UTAU"},
    {38, "SV_WALL_T"},
    {59, "SV_MACH"},
    {63, "SV_O"},
    {96, "SV_WALL_DIST"},
    {101, "SV_DENSITY"},
    {102, "SV_MU_LAM"},
    {103, "SV_MU_T"},
    {104, "SV_CP"},
    {105, "SV_KTC"},
    {111, "SV_U"},
    {112, "SV_V"},
    {113, "SV_W"},
    {114, "SV_WALL_V"},
    {150, "SV_VOF"},
    {420, "SV_DPM_PARTITION"},
    {500, "SV_NUT"},
    {700, "SV_UDS_0"},
    {701, "SV_UDS_1"},
    {702, "SV_UDS_2"},
    {703, "SV_UDS_3"},
}};

}  // namespace

std::string fluent_variable(int number) {
    for (const auto& [known, name] : numbers) {
        if (known == number) {
            return name;
        }
    }
    if (number >= 200 && number < 300) {
        return "SV_Y_" + std::to_string(number - 200);
    }
    return "SV_" + std::to_string(number);
}

bool wants_variable(const ReadOptions& options, const std::string& variable) {
    if (options.arrays.empty() || matches_any(options.arrays, variable)) {
        return true;
    }
    const std::string canonical = canonical_name(variable).name;
    if (matches_any(options.arrays, canonical)) {
        return true;
    }
    const auto component = vector_component(canonical);
    return (component && matches_any(options.arrays, component->vector)) ||
           (canonical == "wall_shear_force" && matches_any(options.arrays, "wall_shear"));
}

ReadOptions for_pressure_of_cells(const ReadOptions& options) {
    ReadOptions again = options;
    again.surfaces_only = false;
    again.arrays = {"SV_P"};
    return again;
}

}  // namespace underbody::postproc
