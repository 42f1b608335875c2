// The tables of [design] for the format of study.toml.
#include <algorithm>

#include "cases/design_curves.h"
#include "cases/design_spec.h"
#include "core/text.h"

namespace underbody::cases {

using core::FileTable;

std::vector<FileTable> design_tables() {
    const core::FileKey at{"*", "1", "gap = \"5 mm\"", "", "a condition that takes several values in [design]"};
    const auto response = [](std::vector<core::FileKey> more) {
        std::vector<core::FileKey> keys = {
            {"quantity", "text", "\"lift_force\"", "",
             "one of design.quantities; of a pitch window pitch_moment where left out"},
            {"slope_along", "text", "\"pitch\"", "none", "its slope along this condition, not its value"},
            {"half_width", "rad or m or m/s", "\"1 deg\"", "1 deg, 1 mm, 1 mm/s",
             "the slope is the difference over twice this"},
            {"name", "text", "\"lift\"", "made of the others", "what it is called in tables"}};
        const auto of_curves = curve_keys();
        keys.insert(keys.end(), of_curves.begin(), of_curves.end());
        keys.insert(keys.end(), more.begin(), more.end());
        return keys;
    };
    std::vector<FileTable> tables = {
        {"design",
         "shapes to be tried: a plan, surrogates of what was computed, what to compute next, the best",
         {{"shape", "file", "\"shapes/evie.toml\"", "", "SHAPE.toml that is varied"},
          {"folder", "text", "\"design\"", "design", "of plan, shapes, runs and results, relative to this file"},
          {"plan", "sobol | latin_hypercube", "\"sobol\"", "sobol", "how the first designs fill the ranges"},
          {"points", "whole number", "24", "24", "designs of the first plan"},
          {"seed", "whole number", "1", "1", "of the plan and the searches"},
          {"gap", "m or list of m", "[\"3 mm\", \"5 mm\", \"10 mm\"]", "5 mm", "every design is computed at these"},
          {"pitch", "rad or list of rad", "[\"-1 deg\", \"1 deg\"]", "0", "and at these, positive nose up"},
          {"speed", "m/s or list of m/s", "\"0.5 m/s\"", "0.5 m/s", "and at these"},
          {"kinematic_viscosity", "m^2/s", "\"1.0e-6 m^2/s\"",
           core::format_number(DesignSpec().kinematic_viscosity) + " m^2/s", "of the water"},
          {"quantities", "list of texts", "[\"lift_force\", \"pitch_moment\"]", "lift_force, drag_force, pitch_moment",
           "loads that are learned"}}},
        {"design.vary[]",
         "a number of the shape and its range",
         {{"key", "text", "\"protrusion.height\"", "", "as in SHAPE.toml"},
          {"from", "unit of the key", "\"1 mm\"", "", "lower end"},
          {"to", "unit of the key", "\"3 mm\"", "", "upper end"},
          {"logarithmic", "true or false", "false", "false", "ratios count, not differences"}}},
        {"design.tie[]",
         "a number of the shape that follows another one",
         {{"key", "text", "\"protrusion.length\"", "", "the one that follows"},
          {"of", "text", "\"protrusion.height\"", "", "the one it follows"},
          {"factor", "1", "5", "1", "times this"},
          {"offset", "unit of the key", "\"0 mm\"", "0", "plus this"}}},
        {"design.fidelity[]",
         "a mesh; the cheapest first, the last is what counts",
         {{"name", "text", "\"coarse\"", "", "its folder below runs"},
          {"cost", "s", "\"120 s\"", "1 s", "core-seconds of a case, to weigh what pays"}}},
        {"design.objective[]", "what is wanted; several make a front",
         response({{"sense", "minimise | maximise", "\"maximise\"", "", "which way"},
                   {"target", "unit of the quantity", "\"0.3 N\"", "none", "the value that is wanted", "sense"}})},
        {"design.objective[].at", "the conditions it is taken at", {at}, false, "at = { gap = \"5 mm\" }"},
        {"design.limit[]", "what must hold of a quantity",
         response({{"at_least", "unit of the quantity", "\"0.1 N\"", "", "lower limit"},
                   {"at_most", "unit of the quantity", "\"0.5 N\"", "none", "upper limit", "at_least"}})},
        {"design.limit[].at", "the conditions it is taken at", {at}, false, "at = { gap = \"5 mm\" }"},
        {"design.volume",
         "what must hold of the body's volume: known without a run",
         {{"at_least", "m^3", "\"1 L\"", "0", "lower limit"}, {"at_most", "m^3", "\"4 L\"", "none", "upper limit"}}}};
    const auto of_jet = jet_axis_keys();
    tables.front().keys.insert(tables.front().keys.end(), of_jet.begin(), of_jet.end());
    const auto for_curves = keys_for_curves();
    tables.front().keys.insert(tables.front().keys.end(), for_curves.begin(), for_curves.end());
    const auto of_mesh = case_mesh_keys("the name, where it is one of these, else medium");
    const auto fidelity = std::find_if(tables.begin(), tables.end(),
                                       [](const FileTable& table) { return table.path == "design.fidelity[]"; });
    fidelity->keys.insert(fidelity->keys.end(), of_mesh.begin(), of_mesh.end());
    return tables;
}

}  // namespace underbody::cases
