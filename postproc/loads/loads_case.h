// A file's loads with the conditions it was computed for, as tables and mesh studies take them.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "postproc/loads/loads.h"
#include "postproc/loads/settled.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::postproc {

/// A file's loads with the conditions it was computed for.
struct LoadsCase {
    std::string file;
    std::vector<std::pair<std::string, double>> numbers;  ///< condition -> SI value; quantity names get their units
    std::vector<std::pair<std::string, std::string>> texts;
    LoadsResult loads;
    std::vector<std::pair<std::string, double>> sigmas;           ///< lift_force -> standard uncertainty, SI
    std::vector<std::pair<std::string, MeshUncertainty>> meshes;  ///< lift_force -> what the mesh study says
    std::vector<std::pair<std::string, double>>
        scatters{};                         ///< lift_force -> standard uncertainty by iteration (iteration_sigmas)
    std::vector<Comparison> comparisons{};  ///< with the solver's own report
    Settled settled{};                      ///< has the solution settled?
};

template <typename T>
T value_of(const std::vector<std::pair<std::string, T>>& list, const std::string& name, T fallback) {
    for (const auto& [key, value] : list) {
        if (key == name) {
            return value;
        }
    }
    return fallback;
}

template <typename T>
bool has(const std::vector<std::pair<std::string, T>>& list, const std::string& name) {
    return std::any_of(list.begin(), list.end(), [&](const auto& entry) { return entry.first == name; });
}

/// Does a table of loads give this name, with or without _sigma, _scatter, _stated, to what it found? A condition of
/// such a name (the table of an earlier run as the manifest) does not tell cases apart.
bool is_result(std::string name);

}  // namespace underbody::postproc
