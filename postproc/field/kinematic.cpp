#include "postproc/field/kinematic.h"

#include <vtkCellData.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>

namespace underbody::postproc {

namespace {

struct Pair {
    const char* kinematic;
    const char* dynamic;
};
constexpr std::array pairs = {Pair{"kinematic_pressure", "pressure"}, Pair{"kinematic_wall_shear", "wall_shear"}};

void multiply(vtkDataSetAttributes& data, const Pair& pair, double density) {
    auto* from = data.GetArray(pair.kinematic);
    if (from == nullptr) {
        return;
    }
    vtkNew<vtkDoubleArray> to;
    to->SetName(pair.dynamic);
    to->SetNumberOfComponents(from->GetNumberOfComponents());
    to->SetNumberOfTuples(from->GetNumberOfTuples());
    for (vtkIdType i = 0; i < from->GetNumberOfTuples(); ++i) {
        for (int k = 0; k < from->GetNumberOfComponents(); ++k) {
            to->SetComponent(i, k, density * from->GetComponent(i, k));
        }
    }
    data.AddArray(to);
    data.RemoveArray(pair.kinematic);
}

}  // namespace

bool is_kinematic(const Field& field) {
    const auto has = [&](const char* name) {
        return std::any_of(field.zones.begin(), field.zones.end(),
                           [&](const Zone& zone) { return zone.find(name) != nullptr; });
    };
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const Pair& pair) { return has(pair.kinematic) && !has(pair.dynamic); });
}

void multiply_by_density(Field& field, double density) {
    for (auto& zone : field.zones) {
        vtkDataSet* data = zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume.Get())
                                                  : static_cast<vtkDataSet*>(zone.surface.Get());
        if (data == nullptr) {
            continue;
        }
        for (const auto& pair : pairs) {
            if (zone.find(pair.dynamic) != nullptr) {
                continue;
            }
            multiply(*data->GetPointData(), pair, density);
            multiply(*data->GetCellData(), pair, density);
            for (auto& info : zone.arrays) {
                if (info.name == pair.kinematic) {
                    info.name = pair.dynamic;
                    info.unit = "Pa";
                }
            }
        }
    }
}

bool bring_to_pascal(Field& field, std::optional<double> density) {
    density = density ? density : field.density;
    if (density) {
        multiply_by_density(field, *density);
    }
    return !is_kinematic(field);
}

}  // namespace underbody::postproc
