#include "postproc/importers/mesh/array_names.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/text.h"
#include "postproc/field/names.h"

namespace underbody::postproc {

namespace {

constexpr std::array axes = {"x", "y", "z"};

/// "x (2)" where "x" is taken; letters count alike, small or large.
std::string free_name(const std::string& wanted, std::unordered_set<std::string>& taken) {
    std::string name = wanted;
    for (int number = 2; !taken.insert(core::lower_case(name)).second; ++number) {
        name = wanted + " (" + std::to_string(number) + ")";
    }
    return name;
}

/// What there is of a vector: places of x, y, z in the plans.
using Parts = std::array<ArrayPlan*, 3>;

std::string in_words(const Parts& parts, bool there) {
    std::string text;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if ((parts[k] != nullptr) == there) {
            text += (text.empty() ? "" : there ? ", " : " and ") + (there ? parts[k]->name : std::string(axes[k]));
        }
    }
    return text;
}

}  // namespace

CanonicalName named_as_scalar(CanonicalName canonical) {
    if (vector_component(canonical.name + "_x")) {
        canonical.name += "_magnitude";
    }
    return canonical;
}

namespace {

/// Scalars U, V (and W) are the components of a velocity, as Tecplot files and others name them; "U" alone may be its
/// size.
void name_u_as_component(std::vector<ArrayPlan>& plans) {
    const auto scalar = [&](const char* letter, const char* meaning) {
        const auto found = std::find_if(plans.begin(), plans.end(), [&](const ArrayPlan& plan) {
            return plan.components == 1 && core::lower_case(plan.own) == letter && plan.name == meaning;
        });
        return found == plans.end() ? nullptr : &*found;
    };
    ArrayPlan* first = scalar("u", "velocity_magnitude");
    if (first != nullptr && scalar("v", "velocity_y") != nullptr && scalar("u", "velocity_x") == nullptr) {
        first->name = "velocity_x";
    }
}

}  // namespace

void settle_names(std::vector<ArrayPlan>& plans, const core::Place& place, core::Problems& problems) {
    name_u_as_component(plans);
    std::unordered_map<std::string, ArrayPlan*> plainest;
    for (auto& plan : plans) {
        if (plan.name.empty()) {
            continue;
        }
        auto& best = plainest[plan.name];
        if (best == nullptr || spelling_rank(plan.own, plan.name) < spelling_rank(best->own, plan.name)) {
            best = &plan;
        }
    }
    std::unordered_set<std::string> taken;
    for (const auto& [name, best] : plainest) {
        taken.insert(core::lower_case(name));
    }
    for (auto& plan : plans) {
        const auto found = plainest.find(plan.name);
        if (found == plainest.end() || found->second == &plan) {
            continue;
        }
        const std::string meaning = plan.name;
        plan.name = free_name(plan.own, taken);
        say_once(problems, {core::Problem::Severity::warning,
                            "'" + plan.own + "' and '" + found->second->own + "' both mean " + meaning + ": that is '" +
                                found->second->own + "' here, the other is kept as '" + plan.name + "'",
                            place});
    }
}

bool is_wanted(const ReadOptions& options, const std::string& own, const std::string& name, const std::string& phase) {
    if (matches_any(options.arrays, own) || matches_any(options.arrays, name + phase)) {
        return true;
    }
    const auto component = vector_component(name);
    return component && matches_any(options.arrays, component->vector + phase);
}

void join_components(std::vector<ArrayPlan>& plans, int dimension, const ReadOptions& options, const core::Place& place,
                     core::Problems& problems) {
    std::map<std::string, Parts> vectors;
    std::set<std::string> taken;
    for (auto& plan : plans) {
        const auto component = plan.components == 1 ? vector_component(plan.name) : std::nullopt;
        if (component) {
            vectors[component->vector][static_cast<std::size_t>(component->index)] = &plan;
        }
        taken.insert(plan.name);
    }
    for (auto& [vector, parts] : vectors) {
        if (taken.contains(vector)) {
            continue;  // the file has the vector too
        }
        if (parts[0] == nullptr || parts[1] == nullptr || (parts[2] == nullptr && dimension != 2)) {
            if (matches_any(options.arrays, vector)) {
                say_once(problems, {core::Problem::Severity::warning,
                                    vector + " has no " + in_words(parts, false) + " component here: no vector, but " +
                                        in_words(parts, true),
                                    place});
            }
            continue;
        }
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (parts[k] != nullptr) {
                parts[k]->name = vector;
                parts[k]->component = static_cast<int>(k);
            }
        }
    }
}

Buffer<double> interleaved(const std::array<const Buffer<double>*, 3>& parts, std::size_t count) {
    Buffer<double> result(3 * count);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t there = parts[k] == nullptr ? 0 : std::min(count, parts[k]->size());
        for (std::size_t i = 0; i < count; ++i) {
            result[3 * i + k] = i < there ? (*parts[k])[i] : 0;
        }
    }
    return result;
}

void say_once(core::Problems& problems, core::Problem problem) {
    const bool said = std::any_of(problems.begin(), problems.end(),
                                  [&](const auto& other) { return other.message == problem.message; });
    if (!said) {
        problems.push_back(std::move(problem));
    }
}

}  // namespace underbody::postproc
