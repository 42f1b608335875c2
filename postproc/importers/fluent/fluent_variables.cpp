#include "postproc/importers/fluent/fluent_variables.h"

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

bool needs_pressure_of_cells(const FaceMesh& mesh, const std::vector<ValueBlock>& values, const ReadOptions& options) {
    const auto has_own = [&](const FaceBlock& faces) {
        return std::any_of(values.begin(), values.end(), [&](const ValueBlock& block) {
            return !block.on_cells && block.variable == pressure_variable && block.phase == 1 &&
                   block.first < faces.first + faces.count && faces.first < block.first + block.count;
        });
    };
    return options.surfaces_only && wants_variable(options, pressure_variable) &&
           std::any_of(mesh.face_blocks.begin(), mesh.face_blocks.end(), [&](const FaceBlock& faces) {
               const ZoneLabel* label = mesh.label(faces.zone);
               const std::string type =
                   label != nullptr && !label->type.empty() ? label->type : type_of_code(faces.kind);
               return faces.count > 0 && kind_of_type(type) == ZoneKind::wall && !has_own(faces);
           });
}

ReadOptions for_pressure_of_cells(const ReadOptions& options) {
    ReadOptions again = options;
    again.surfaces_only = false;
    again.arrays = {pressure_variable};
    return again;
}

}  // namespace underbody::postproc
