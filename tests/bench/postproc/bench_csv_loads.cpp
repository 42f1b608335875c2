// CFD-Post CSV into VTK against numpy's readers; loads against VTK's own filter chain.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <vtkArrayCalculator.h>
#include <vtkCellArray.h>
#include <vtkCellCenters.h>
#include <vtkCellData.h>
#include <vtkCellSizeFilter.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPointDataToCellData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataNormals.h>
#include <vtkTypeInt64Array.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "core/file.h"
#include "core/parallel.h"
#include "postproc/loads/loads.h"

namespace underbody::postproc {
namespace {

/// An ellipsoid of rings x 2 rings quads with pressure and shear, as CFD-Post writes it.
std::string csv_of(int rings) {
    std::string text =
        "\n[Name]\nhull\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], Wall Shear X [ Pa ], Wall Shear Y [ Pa "
        "], Wall Shear Z [ Pa ], Yplus\n";
    const int around = 2 * rings;
    char line[256];
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const double theta = M_PI * (i + 0.01) / (rings + 0.02);
            const double phi = 2 * M_PI * j / around;
            const double x = 0.1 * std::sin(theta) * std::cos(phi);
            const double y = 0.08 * std::sin(theta) * std::sin(phi);
            const double z = 0.06 * std::cos(theta);
            const int size = std::snprintf(line, sizeof line, "%.8e, %.8e, %.8e, %.6e, %.6e, %.6e, %.6e, %.4e\n", x, y,
                                           z, -9806 * z, 0.3 * x, -0.2 * y, 0.1 * z, 0.9 + x);
            text.append(line, static_cast<std::size_t>(size));
        }
    }
    text += "\n[Faces]\n";
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const int a = i * around + j;
            const int b = i * around + (j + 1) % around;
            const int size = std::snprintf(line, sizeof line, "%d, %d, %d, %d\n", a, a + around, b + around, b);
            text.append(line, static_cast<std::size_t>(size));
        }
    }
    return text;
}

const std::filesystem::path& big_file() {
    static const core::TemporaryFolder folder("underbody-bench");
    static const std::filesystem::path path = [] {
        const auto file = folder.path() / "big.csv";
        std::ofstream(file, std::ios::binary) << csv_of(900);
        return file;
    }();
    return path;
}

double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

void read_csv(benchmark::State& state) {
    core::set_threads(static_cast<int>(state.range(0)));
    const auto bytes = std::filesystem::file_size(big_file());
    const double before = peak_megabytes();
    std::size_t arrays = 0;
    for (auto _ : state) {
        const Field field = read_field(big_file());
        arrays = field.zones[0].surface->GetActualMemorySize() * 1024;
        benchmark::DoNotOptimize(field.zones.data());
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(bytes) * state.iterations());
    state.counters["file_MB"] = static_cast<double>(bytes) / 1e6;
    state.counters["arrays_MB"] = static_cast<double>(arrays) / 1e6;
    state.counters["peak_over_arrays"] = (peak_megabytes() - before) * 1048576 / static_cast<double>(arrays);
    core::set_threads(0);
}
BENCHMARK(read_csv)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// numpy reads the rows of numbers alone, from a file that holds nothing else.
void numpy_reader(benchmark::State& state, const char* function) {
    if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) {
        state.SkipWithError("skipped: Debian's python3-numpy is not here");
        return;
    }
    const core::TemporaryFolder folder;
    const std::string whole = csv_of(250);
    const auto from = whole.find('\n', whole.find("[Data]") + 7) + 1;
    const std::string rows = whole.substr(from, whole.find("\n[Faces]") - from);
    std::ofstream(folder.path() / "rows.csv", std::ios::binary) << rows;
    const std::string script = "import numpy,time;numpy." + std::string(function) + "('" +
                               (folder.path() / "rows.csv").string() +
                               "',delimiter=',',max_rows=10);t=time.perf_counter();numpy." + function + "('" +
                               (folder.path() / "rows.csv").string() + "',delimiter=',');open('" +
                               (folder.path() / "t").string() + "','w').write(str(time.perf_counter()-t))";
    for (auto _ : state) {
        if (std::system(("/usr/bin/python3 -c \"" + script + "\"").c_str()) != 0) {
            state.SkipWithError("numpy failed");
            return;
        }
        state.SetIterationTime(std::stod(core::read_file(folder.path() / "t")));
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(rows.size()) * state.iterations());
}
BENCHMARK_CAPTURE(numpy_reader, loadtxt, "loadtxt")->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(numpy_reader, genfromtxt, "genfromtxt")
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

/// The same surface made in memory: 5 million faces.
Field big_surface(int rings) {
    const int around = 2 * rings;
    const auto nodes = static_cast<vtkIdType>(rings + 1) * around;
    vtkNew<vtkDoubleArray> places;
    places->SetNumberOfComponents(3);
    places->SetNumberOfTuples(nodes);
    vtkNew<vtkDoubleArray> pressure;
    pressure->SetName("pressure");
    pressure->SetNumberOfTuples(nodes);
    vtkNew<vtkDoubleArray> shear;
    shear->SetName("wall_shear");
    shear->SetNumberOfComponents(3);
    shear->SetNumberOfTuples(nodes);
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const double theta = M_PI * (i + 0.01) / (rings + 0.02);
            const double phi = 2 * M_PI * j / around;
            const double p[3] = {0.1 * std::sin(theta) * std::cos(phi), 0.08 * std::sin(theta) * std::sin(phi),
                                 0.06 * std::cos(theta)};
            const vtkIdType n = static_cast<vtkIdType>(i) * around + j;
            places->SetTuple(n, p);
            pressure->SetValue(n, -9806 * p[2]);
            shear->SetTuple(n, p);
        }
    }
    vtkNew<vtkTypeInt64Array> offsets;
    vtkNew<vtkTypeInt64Array> connectivity;
    const auto faces = static_cast<vtkIdType>(rings) * around;
    offsets->SetNumberOfValues(faces + 1);
    connectivity->SetNumberOfValues(4 * faces);
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const vtkIdType f = static_cast<vtkIdType>(i) * around + j;
            const vtkIdType b = static_cast<vtkIdType>(i) * around + (j + 1) % around;
            offsets->SetValue(f, 4 * f);
            const vtkIdType ids[4] = {f, f + around, b + around, b};
            for (int k = 0; k < 4; ++k) {
                connectivity->SetValue(4 * f + k, ids[k]);
            }
        }
    }
    offsets->SetValue(faces, 4 * faces);
    Zone zone;
    zone.name = "hull";
    zone.kind = ZoneKind::wall;
    zone.normals_into_fluid = false;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetData(places);
    vtkNew<vtkCellArray> cells;
    cells->SetData(offsets, connectivity);
    zone.surface->SetPoints(points);
    zone.surface->SetPolys(cells);
    zone.surface->GetPointData()->AddArray(pressure);
    zone.surface->GetPointData()->AddArray(shear);
    zone.arrays = {{"pressure", "Pa", "Pressure", "Pa", Location::nodes, 1},
                   {"wall_shear", "Pa", "Wall Shear X", "Pa", Location::nodes, 3}};
    Field field;
    field.files = {"made"};
    field.zones.push_back(std::move(zone));
    return field;
}

void loads_of_five_million_faces(benchmark::State& state) {
    static const Field field = big_surface(1581);
    core::set_threads(static_cast<int>(state.range(0)));
    LoadsOptions options;
    options.reference = Vector{0, 0, 0};
    for (auto _ : state) {
        benchmark::DoNotOptimize(loads(field, options).named.lift_force);
    }
    state.SetItemsProcessed(state.iterations() * field.zones[0].surface->GetNumberOfPolys());
    core::set_threads(0);
}
BENCHMARK(loads_of_five_million_faces)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// VTK's own way to the same numbers: normals, sizes and centres of the cells, node to cell values, calculators for the
/// two forces and their moments, and sums.
void vtk_filter_chain(benchmark::State& state) {
    static const Field field = big_surface(500);
    const auto calculator = [](vtkAlgorithm& from, const char* formula, const char* name) {
        auto result = vtkSmartPointer<vtkArrayCalculator>::New();
        result->SetInputConnection(from.GetOutputPort());
        result->SetAttributeTypeToCellData();
        for (const char* scalar : {"pressure", "Area"}) {
            result->AddScalarArrayName(scalar);
        }
        for (const char* vector : {"Normals", "wall_shear", "centre", "fp", "fv"}) {
            result->AddVectorArrayName(vector);
        }
        result->SetIgnoreMissingArrays(true);
        result->SetFunction(formula);
        result->SetResultArrayName(name);
        return result;
    };
    for (auto _ : state) {
        vtkNew<vtkPolyDataNormals> normals;
        normals->SetInputData(field.zones[0].surface);
        normals->ComputePointNormalsOff();
        normals->ComputeCellNormalsOn();
        normals->SplittingOff();
        normals->ConsistencyOff();
        vtkNew<vtkCellSizeFilter> sizes;
        sizes->SetInputConnection(normals->GetOutputPort());
        sizes->ComputeVolumeOff();
        sizes->ComputeLengthOff();
        sizes->ComputeVertexCountOff();
        vtkNew<vtkPointDataToCellData> to_cells;
        to_cells->SetInputConnection(sizes->GetOutputPort());
        to_cells->Update();
        vtkNew<vtkCellCenters> centres;
        centres->SetInputConnection(to_cells->GetOutputPort());
        centres->VertexCellsOff();
        centres->Update();
        vtkDataArray* places = centres->GetOutput()->GetPoints()->GetData();
        places->SetName("centre");
        vtkDataSet::SafeDownCast(to_cells->GetOutput())->GetCellData()->AddArray(places);
        auto fp = calculator(*to_cells, "-pressure*Area*Normals", "fp");
        auto fv = calculator(*fp, "Area*wall_shear", "fv");
        auto mp = calculator(*fv, "cross(centre,fp)", "mp");
        auto mv = calculator(*mp, "cross(centre,fv)", "mv");
        mv->Update();
        auto* data = vtkDataSet::SafeDownCast(mv->GetOutput())->GetCellData();
        double sums[4][3] = {};
        int which = 0;
        for (const char* name : {"fp", "fv", "mp", "mv"}) {
            vtkDataArray* array = data->GetArray(name);
            for (vtkIdType i = 0; array != nullptr && i < array->GetNumberOfTuples(); ++i) {
                for (int k = 0; k < 3; ++k) {
                    sums[which][k] += array->GetComponent(i, k);
                }
            }
            if (array == nullptr) {
                state.SkipWithError("VTK gave no result");
            }
            ++which;
        }
        benchmark::DoNotOptimize(sums[0][2]);
    }
    state.SetItemsProcessed(state.iterations() * field.zones[0].surface->GetNumberOfPolys());
}
BENCHMARK(vtk_filter_chain)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace underbody::postproc
