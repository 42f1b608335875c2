// The 3D view: which arrays can colour the surfaces, and the colours of one of them.
#include <vtkCellData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/views/colours.h"
#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

using postproc::Location;

std::vector<Scene::Choice> Scene::choices() const {
    std::vector<Choice> result;
    const auto add = [&](Choice choice) {
        if (std::none_of(result.begin(), result.end(), [&](const Choice& c) { return c.label == choice.label; })) {
            result.push_back(std::move(choice));
        }
    };
    for (const auto& surface : parts_->surfaces) {
        for (const auto& info : parts_->field->zones[surface.zone].arrays) {
            if (array_of(parts_->field->zones[surface.zone], info) == nullptr) {
                continue;
            }
            std::string words = info.name;
            std::replace(words.begin(), words.end(), '_', ' ');
            add({info.name, -1, words, info.unit});
            for (int c = 0; info.components == 3 && c < 3; ++c) {
                add({info.name, c, words + " " + "xyz"[c], info.unit});
            }
        }
    }
    return result;
}

std::optional<std::array<double, 2>> Scene::range_of(const Choice& choice, bool whole_range) const {
    const Parts& p = *parts_;
    std::vector<double> values;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const auto& surface : p.surfaces) {
        const auto* info = choice.name.empty() ? nullptr : p.field->zones[surface.zone].find(choice.name);
        vtkDataArray* array =
            info != nullptr && visible(surface.zone) ? array_of(p.field->zones[surface.zone], *info) : nullptr;
        const vtkIdType count = array != nullptr ? array->GetNumberOfTuples() : 0;
        // Of a large surface every n-th value is enough to know its hundredths.
        const vtkIdType step = whole_range ? 1 : std::max<vtkIdType>(1, count / 50000);
        for (vtkIdType i = 0; i < count; i += step) {
            const double value = value_of(*array, i, choice.component);
            if (!std::isfinite(value)) {
                continue;
            }
            lowest = std::min(lowest, value);
            highest = std::max(highest, value);
            if (!whole_range) {
                values.push_back(value);
            }
        }
    }
    if (!(lowest <= highest)) {
        return {};
    }
    if (whole_range) {
        return std::array<double, 2>{lowest, highest};
    }
    const std::size_t cut = values.size() / 100;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cut), values.end());
    lowest = values[cut];
    std::nth_element(values.begin(), values.end() - 1 - static_cast<std::ptrdiff_t>(cut), values.end());
    return std::array<double, 2>{lowest, values[values.size() - 1 - cut]};
}

void Scene::colour_by(const Choice& choice, std::array<double, 2> range) {
    Parts& p = *parts_;
    p.choice = choice;
    bool any = false;
    for (auto& surface : p.surfaces) {
        const auto* info = choice.name.empty() ? nullptr : p.info(surface);
        vtkDataArray* array = info != nullptr ? array_of(p.field->zones[surface.zone], *info) : nullptr;
        // The component along the mirror has the other sign behind it: better plain than wrong.
        const bool across = choice.component >= 0 && p.mirror.axis == choice.component;
        surface.mapper->SetScalarVisibility(array != nullptr && p.tinted.empty());
        surface.mirrored_mapper->SetScalarVisibility(array != nullptr && !across && p.tinted.empty());
        if (array == nullptr) {
            continue;
        }
        any = any || visible(surface.zone);
        for (const auto& mapper : {surface.mapper, surface.mirrored_mapper}) {
            if (info->on == Location::nodes) {
                mapper->SetScalarModeToUsePointFieldData();
            } else {
                mapper->SetScalarModeToUseCellFieldData();
            }
            mapper->SelectColorArray(info->name.c_str());
        }
    }
    auto [lower, upper] = range;
    const bool both_signs = is_around_zero(range);
    if (both_signs) {
        upper = std::max(-lower, upper);
        lower = -upper;
    }
    p.colours->SetNumberOfTableValues(256);
    for (int i = 0; i < 256; ++i) {
        // Those of the pictures and of the report.
        const auto c =
            postproc::colour_at(both_signs ? postproc::ColourMap::diverging : postproc::ColourMap::viridis, i / 255.0);
        p.colours->SetTableValue(i, c[0], c[1], c[2]);
    }
    p.colours->SetTableRange(lower, upper > lower ? upper : lower + 1);
    if (choice.component >= 0) {
        p.colours->SetVectorModeToComponent();
        p.colours->SetVectorComponent(choice.component);
    } else {
        p.colours->SetVectorModeToMagnitude();
    }
    p.bar_label = choice.label;
    p.bar_unit = choice.unit;
    p.bar->SetVisibility(any && p.tinted.empty());
}

}  // namespace underbody::studio
