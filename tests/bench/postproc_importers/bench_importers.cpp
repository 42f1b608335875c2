// Legacy Fluent files against VTK 9.1's reader on the same file: time and peak memory, each reading in its own process.
// Usage: bench_postproc_importers [cells along an edge, default 60]
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkCellData.h>
#include <vtkFLUENTReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "core/file.h"
#include "postproc/field.h"

namespace {

namespace fs = std::filesystem;
using namespace underbody;

struct Cost {
    double seconds = 0;
    double megabytes = 0;  ///< more than a process that reads nothing
    bool good = false;
};

/// The median of three runs, each in a fresh process.
Cost cost_of(const std::function<long long()>& read, long long expected) {
    std::vector<Cost> runs;
    for (int i = 0; i < 3; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const pid_t child = ::fork();
        if (child == 0) {
            ::alarm(300);
            long long found = -1;
            try {
                found = read();
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s\n", error.what());
            }
            ::_exit(found == expected ? 0 : 1);
        }
        int status = 0;
        rusage usage{};
        ::wait4(child, &status, 0, &usage);
        const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        runs.push_back(
            {time.count(), static_cast<double>(usage.ru_maxrss) / 1024, WIFEXITED(status) && WEXITSTATUS(status) == 0});
    }
    std::sort(runs.begin(), runs.end(), [](const Cost& a, const Cost& b) { return a.seconds < b.seconds; });
    return runs[1];
}

/// A cube of n x n x n hexahedra with one wall zone and five cell fields.
void write_case(const fs::path& path, std::uint32_t n, bool binary) {
    std::FILE* out = std::fopen(path.c_str(), "wb");
    const std::uint32_t m = n + 1;
    const auto node = [m](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return 1 + i + m * (j + m * k); };
    const auto cell = [n](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return 1 + i + n * (j + n * k); };
    std::vector<std::uint32_t> inner;
    std::vector<std::uint32_t> outer;
    const std::uint32_t step[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int d = 0; d < 3; ++d) {
        const auto* a = step[(d + 1) % 3];
        const auto* b = step[(d + 2) % 3];
        for (std::uint32_t k = 0; k < n + step[d][2]; ++k) {
            for (std::uint32_t j = 0; j < n + step[d][1]; ++j) {
                for (std::uint32_t i = 0; i < n + step[d][0]; ++i) {
                    const std::uint32_t at[3] = {i, j, k};
                    const bool low = at[d] == 0;
                    const bool high = at[d] == n;
                    const auto corner = [&](int u, int v) {
                        return node(i + u * a[0] + v * b[0], j + u * a[1] + v * b[1], k + u * a[2] + v * b[2]);
                    };
                    std::uint32_t c0 = high ? 0 : cell(i, j, k);
                    std::uint32_t c1 = low ? 0 : cell(i - step[d][0], j - step[d][1], k - step[d][2]);
                    std::uint32_t nodes[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
                    if (c0 == 0) {
                        std::swap(c0, c1);
                        std::swap(nodes[1], nodes[3]);
                    }
                    auto& list = low || high ? outer : inner;
                    list.insert(list.end(), {nodes[0], nodes[1], nodes[2], nodes[3], c0, c1});
                }
            }
        }
    }
    const std::size_t faces = (inner.size() + outer.size()) / 6;
    std::fprintf(out,
                 "(0 \"bench\")\n(2 3)\n(4 (60 0 0 1 2 4 4 4 8 8 8 4))\n(10 (0 1 %x 0 3))\n(12 (0 1 %x 0 0))\n(13 (0 1 "
                 "%zx 0 0))\n(12 (2 1 %x 1 4))\n",
                 m * m * m, n * n * n, faces, n * n * n);
    std::size_t first = 1;
    int zone = 3;
    for (const auto* list : {&inner, &outer}) {
        std::fprintf(out, "(%s (%x %zx %zx %x 4)(", binary ? "3013" : "13", zone, first, first + list->size() / 6 - 1,
                     zone == 3 ? 2 : 3);
        if (binary) {
            std::fwrite(list->data(), 4, list->size(), out);
            std::fprintf(out, ")\nEnd of Binary Section   3013)\n");
        } else {
            std::fputc('\n', out);
            for (std::size_t i = 0; i < list->size(); i += 6) {
                std::fprintf(out, "%x %x %x %x %x %x\n", (*list)[i], (*list)[i + 1], (*list)[i + 2], (*list)[i + 3],
                             (*list)[i + 4], (*list)[i + 5]);
            }
            std::fprintf(out, "))\n");
        }
        first += list->size() / 6;
        ++zone;
    }
    std::fprintf(out, "(%s (1 1 %x 1 3)(", binary ? "3010" : "10", m * m * m);
    if (!binary) {
        std::fputc('\n', out);
    }
    for (std::uint32_t k = 0; k < m; ++k) {
        for (std::uint32_t j = 0; j < m; ++j) {
            for (std::uint32_t i = 0; i < m; ++i) {
                const double p[3] = {i / 7.0, j / 11.0, k / 13.0};
                if (binary) {
                    std::fwrite(p, 8, 3, out);
                } else {
                    std::fprintf(out, "%.10e %.10e %.10e\n", p[0], p[1], p[2]);
                }
            }
        }
    }
    std::fprintf(out, binary ? ")\nEnd of Binary Section   3010)\n" : "))\n");
    std::fprintf(out, "(39 (2 fluid fluid 1)())\n(39 (3 interior int-fluid 1)())\n(39 (4 wall hull 1)())\n");
    std::fclose(out);
    std::FILE* data = std::fopen(fs::path(path).replace_extension(".dat").c_str(), "wb");
    std::fprintf(data, "(0 \"bench\")\n(33 (%u %zu %u))\n", n * n * n, faces, m * m * m);
    for (const int variable : {1, 3, 111, 112, 113}) {
        std::fprintf(data, "(%s (%d 2 1 0 1 1 %u)\n(", binary ? "3300" : "300", variable, n * n * n);
        for (std::uint32_t i = 0; i < n * n * n; ++i) {
            const double value = variable + i / 3.0;
            if (binary) {
                std::fwrite(&value, 8, 1, data);
            } else {
                std::fprintf(data, "%.10e\n", value);
            }
        }
        std::fprintf(data, binary ? "\nEnd of Binary Section   3300))\n" : "))\n");
    }
    std::fclose(data);
}

long long read_ours(const fs::path& path, bool surfaces_only) {
    postproc::ReadOptions options;
    options.surfaces_only = surfaces_only;
    const auto field = postproc::read_field(path, options);
    long long cells = 0;
    for (const auto& zone : field.zones) {
        cells += zone.volume != nullptr ? zone.volume->GetNumberOfCells()
                 : surfaces_only        ? zone.surface->GetNumberOfCells()
                                        : 0;
    }
    return cells;
}

long long read_by_vtk(const fs::path& path) {
    vtkNew<vtkFLUENTReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    long long cells = 0;
    for (unsigned int b = 0; b < reader->GetOutput()->GetNumberOfBlocks(); ++b) {
        if (auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutput()->GetBlock(b))) {
            cells += grid->GetNumberOfCells();
        }
    }
    return cells;
}

}  // namespace

int main(int count, char** arguments) {
    const auto n = static_cast<std::uint32_t>(count > 1 ? std::atoi(arguments[1]) : 60);
    const core::TemporaryFolder folder;
    const Cost nothing = cost_of([] { return 0LL; }, 0);
    std::printf("%u hexahedra, five fields; median of three, memory above %.0f MB of the bare process\n", n * n * n,
                nothing.megabytes);
    bool good = true;
    for (const bool binary : {false, true}) {
        const fs::path path = folder.path() / (binary ? "binary.cas" : "ascii.cas");
        write_case(path, n, binary);
        const long long cells = static_cast<long long>(n) * n * n;
        const Cost ours = cost_of([&] { return read_ours(path, false); }, cells);
        const Cost surface = cost_of([&] { return read_ours(path, true); }, 6LL * n * n);
        const Cost vtk = cost_of([&] { return read_by_vtk(path); }, cells);
        const auto memory = [&](const Cost& cost) { return cost.megabytes - nothing.megabytes; };
        std::printf(
            "%-7s ours %.3f s %.0f MB | surface alone %.3f s %.0f MB | VTK %.3f s %.0f MB%s | %.1f times faster, %.2f "
            "of the memory\n",
            binary ? "binary" : "ASCII", ours.seconds, memory(ours), surface.seconds, memory(surface), vtk.seconds,
            memory(vtk), vtk.good ? "" : " (failed)", vtk.seconds / ours.seconds, memory(ours) / memory(vtk));
        good = good && ours.good && surface.good;
    }
    return good ? 0 : 1;
}
