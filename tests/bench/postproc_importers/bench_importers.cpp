// Legacy Fluent files against VTK 9.1's reader on the same file, HDF5 against the library alone and against the disk:
// time and peak memory, each reading in its own process. bench_postproc_importers --help says how.
#include <fcntl.h>
#include <hdf5.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkCellData.h>
#include <vtkFLUENTReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "postproc/field/field.h"

namespace {

namespace fs = std::filesystem;
using namespace underbody;

struct Cost {
    double seconds = 0;    ///< of the median run
    double best = 0;       ///< of the fastest run: what the machine's other work disturbs least
    double processor = 0;  ///< seconds of all cores together, of the run that took the fewest
    double megabytes = 0;  ///< more than a process that reads nothing
    bool good = false;
};

constexpr int repetitions = 9;

/// Several runs, each in a fresh process.
Cost cost_of(
    const std::function<long long()>& read, long long expected, const std::function<void()>& before = [] {}) {
    std::vector<Cost> runs;
    for (int i = 0; i < repetitions; ++i) {
        before();
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
        const auto seconds = [](const timeval& t) {
            return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        };
        runs.push_back({time.count(), 0, seconds(usage.ru_utime) + seconds(usage.ru_stime),
                        static_cast<double>(usage.ru_maxrss) / 1024, WIFEXITED(status) && WEXITSTATUS(status) == 0});
    }
    std::sort(runs.begin(), runs.end(), [](const Cost& a, const Cost& b) { return a.seconds < b.seconds; });
    Cost cost = runs[runs.size() / 2];
    cost.best = runs.front().seconds;
    cost.processor = std::min_element(runs.begin(), runs.end(), [](const Cost& a, const Cost& b) {
                         return a.processor < b.processor;
                     })->processor;
    return cost;
}

/// The faces of a cube of n x n x n hexahedra, each as four nodes and two cells: those inside it and its hull.
struct Cube {
    explicit Cube(std::uint32_t n);
    std::vector<std::uint32_t> inner;
    std::vector<std::uint32_t> outer;
};

Cube::Cube(std::uint32_t n) {
    const std::uint32_t m = n + 1;
    const auto node = [m](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return 1 + i + m * (j + m * k); };
    const auto cell = [n](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return 1 + i + n * (j + n * k); };
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
}

/// With one wall zone and five cell fields.
void write_case(const fs::path& path, std::uint32_t n, bool binary) {
    const auto [inner, outer] = Cube(n);
    std::FILE* out = std::fopen(path.c_str(), "wb");
    const std::uint32_t m = n + 1;
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

/// The same as .cas.h5 and .dat.h5; deflated at level 1 as Fluent does by default, or not at all.
void write_hdf5(const fs::path& path, std::uint32_t n, bool deflated) {
    const auto [inner, outer] = Cube(n);
    const std::uint32_t m = n + 1;
    const std::uint32_t nodes = m * m * m;
    const std::uint32_t cells = n * n * n;
    const auto faces = static_cast<std::uint32_t>((inner.size() + outer.size()) / 6);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    hid_t file = -1;
    const auto attribute = [&](const std::string& object, const char* name, std::int64_t value) {
        const hid_t at = H5Oopen(file, object.c_str(), H5P_DEFAULT);
        const hid_t space = H5Screate(H5S_SCALAR);
        const hid_t made = H5Acreate2(at, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(made, H5T_NATIVE_INT64, &value);
        H5Aclose(made);
        H5Sclose(space);
        H5Oclose(at);
    };
    const auto set = [&](const std::string& name, hid_t type, const void* values, std::vector<hsize_t> size) {
        const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
        if (deflated) {
            size[0] = std::min<hsize_t>(size[0], 65536);
            H5Pset_chunk(properties, static_cast<int>(size.size()), size.data());
            H5Pset_deflate(properties, 1);
        }
        const hid_t made = H5Dcreate2(file, name.c_str(), type, space, links, properties, H5P_DEFAULT);
        H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        H5Dclose(made);
        H5Pclose(properties);
        H5Sclose(space);
    };
    const auto ids = [&](const std::string& name, std::int64_t first, std::int64_t last) {
        attribute(name, "minId", first);
        attribute(name, "maxId", last);
    };
    const auto numbers = [&](const std::string& name, const std::vector<std::uint32_t>& values) {
        set(name, H5T_NATIVE_UINT32, values.data(), {values.size()});
    };
    const std::string root = "/meshes/1";
    file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, root.c_str(), links, H5P_DEFAULT, H5P_DEFAULT));
    attribute(root, "dimension", 3);
    attribute(root, "nodeCount", nodes);
    attribute(root, "faceCount", faces);
    attribute(root, "cellCount", cells);
    std::vector<double> points;
    for (std::uint32_t i = 0; i < nodes; ++i) {
        points.insert(points.end(), {i % m / 7.0, i / m % m / 11.0, i / m / m / 13.0});
    }
    set(root + "/nodes/coords/1", H5T_NATIVE_DOUBLE, points.data(), {nodes, 3});
    ids(root + "/nodes/coords/1", 1, nodes);
    const auto zones = [&](const std::string& where, const std::vector<std::vector<std::uint32_t>>& columns) {
        const char* names[] = {"id", "minId", "maxId", "zoneType", "cellType"};
        for (std::size_t c = 0; c < columns.size(); ++c) {
            numbers(root + where + "/zoneTopology/" + names[c], columns[c]);
        }
    };
    const auto inside = static_cast<std::uint32_t>(inner.size() / 6);
    zones("/cells", {{2}, {1}, {cells}, {1}, {4}});
    zones("/faces", {{3, 4}, {1, inside + 1}, {inside, faces}, {2, 3}});
    std::vector<std::uint32_t> corners;
    std::vector<std::uint32_t> beside[2];
    for (const auto* list : {&inner, &outer}) {
        for (std::size_t i = 0; i < list->size(); i += 6) {
            corners.insert(corners.end(), list->begin() + static_cast<std::ptrdiff_t>(i),
                           list->begin() + static_cast<std::ptrdiff_t>(i) + 4);
            beside[0].push_back((*list)[i + 4]);
            if (list == &inner) {
                beside[1].push_back((*list)[i + 5]);
            }
        }
    }
    numbers(root + "/faces/nodes/1/nnodes", std::vector<std::uint32_t>(faces, 4));
    numbers(root + "/faces/nodes/1/nodes", corners);
    ids(root + "/faces/nodes/1", 1, faces);
    for (int side = 0; side < 2; ++side) {
        const std::string name = root + (side == 0 ? "/faces/c0/1" : "/faces/c1/1");
        numbers(name, beside[side]);
        ids(name, 1, side == 0 ? faces : inside);
    }
    H5Fclose(file);
    std::string data = path.string();
    data.replace(data.size() - 6, 3, "dat");
    file = H5Fcreate(data.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    std::vector<double> values(cells);
    for (const char* variable : {"SV_P", "SV_T", "SV_U", "SV_V", "SV_W"}) {
        for (std::uint32_t i = 0; i < cells; ++i) {
            values[i] = static_cast<double>(variable[3]) + i / 3.0;
        }
        const std::string name = std::string("/results/1/phase-1/cells/") + variable + "/1";
        set(name, H5T_NATIVE_DOUBLE, values.data(), {cells});
        ids(name, 1, cells);
    }
    H5Fclose(file);
    H5Pclose(links);
}

/// The system's copy of a case and its data in memory is given up: who reads them next waits for the disk.
void forget(const fs::path& path) {
    for (const auto& entry : fs::directory_iterator(path.parent_path())) {
        if (entry.path().filename().string().starts_with(path.stem().stem().string())) {
            const int file = ::open(entry.path().c_str(), O_RDONLY);
            ::fdatasync(file);
            ::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
            ::close(file);
        }
    }
}

/// All bytes of a case and its data, as they lie on the disk.
long long read_bytes(const fs::path& path) {
    long long total = 0;
    std::vector<char> block(std::size_t{1} << 20);
    for (const auto& entry : fs::directory_iterator(path.parent_path())) {
        if (entry.path().filename().string().starts_with(path.stem().stem().string())) {
            std::FILE* in = std::fopen(entry.path().c_str(), "rb");
            for (std::size_t got = 1; got > 0;) {
                got = std::fread(block.data(), 1, block.size(), in);
                total += static_cast<long long>(got);
            }
            std::fclose(in);
        }
    }
    return total;
}

/// Every data set through the library alone, into memory that is thrown away.
long long read_by_library(const fs::path& path) {
    long long values = 0;
    const auto visit = [](hid_t object, const char* name, const H5O_info_t* info, void* total) -> herr_t {
        if (info->type == H5O_TYPE_DATASET) {
            const hid_t set = H5Dopen2(object, name, H5P_DEFAULT);
            const hid_t space = H5Dget_space(set);
            const hid_t type = H5Dget_type(set);
            std::vector<double> memory(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
            H5Dread(set, H5Tget_class(type) == H5T_FLOAT ? H5T_NATIVE_DOUBLE : H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL,
                    H5P_DEFAULT, memory.data());
            *static_cast<long long*>(total) += static_cast<long long>(memory.size());
            H5Tclose(type);
            H5Sclose(space);
            H5Dclose(set);
        }
        return 0;
    };
    for (const char* kind : {"cas", "dat"}) {
        std::string name = path.string();
        name.replace(name.size() - 6, 3, kind);
        const hid_t file = H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
        H5Ovisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &values);
        H5Fclose(file);
    }
    return values > 0 ? 0 : -1;
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

constexpr std::uint32_t default_edge = 60;
constexpr std::uint32_t longest_edge = 400;  // 64 million cells: their files fill 9 GB

/// Cells along an edge; ends the program when help was asked for or the command line is no use.
std::uint32_t edge_from(int count, char** arguments) {
    std::uint32_t edge = default_edge;
    const std::string_view text = count > 1 ? arguments[1] : "";
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), edge);
    const bool number = problem == std::errc() && end == text.data() + text.size() && edge >= 2 && edge <= longest_edge;
    if (count == 1 || (count == 2 && number)) {
        return edge;
    }
    const bool help = count == 2 && (text == "--help" || text == "-h");
    std::fprintf(help ? stdout : stderr,
                 "bench_postproc_importers [EDGE]: reads made files of EDGE x EDGE x EDGE hexahedra and five fields, "
                 "Fluent legacy (ASCII, binary) beside\n"
                 "VTK's reader and Fluent HDF5 (plain, deflated) beside the library alone; median time and memory of "
                 "each, in its own process.\n"
                 "  EDGE  cells along an edge, 2 to %u; default %u (README: 110)\n",
                 longest_edge, default_edge);
    std::exit(help ? 0 : 2);
}

}  // namespace

int main(int count, char** arguments) {
    const std::uint32_t n = edge_from(count, arguments);
    const core::TemporaryFolder folder;
    double load = 0;
    ::getloadavg(&load, 1);
    std::printf(
        "%u hexahedra, five fields; median of %d, memory above that of a process that reads nothing; load average at "
        "the start %.1f\n",
        n * n * n, repetitions, load);
    // A child begins with what its parent holds: that is told right before, and kept small.
    const auto bare_process = [] {
        ::malloc_trim(0);
        return cost_of([] { return 0LL; }, 0).megabytes;
    };
    bool good = true;
    for (const bool binary : {false, true}) {
        const fs::path path = folder.path() / (binary ? "binary.cas" : "ascii.cas");
        write_case(path, n, binary);
        const double nothing = bare_process();
        const long long cells = static_cast<long long>(n) * n * n;
        const Cost ours = cost_of([&] { return read_ours(path, false); }, cells);
        const Cost surface = cost_of([&] { return read_ours(path, true); }, 6LL * n * n);
        const Cost vtk = cost_of([&] { return read_by_vtk(path); }, cells);
        const auto memory = [&](const Cost& cost) { return cost.megabytes - nothing; };
        std::printf("%s: VTK %.3f s (best %.3f, processor %.3f) %.0f MB%s\n", binary ? "binary" : "ASCII", vtk.seconds,
                    vtk.best, vtk.processor, memory(vtk), vtk.good ? "" : " (failed)");
        std::printf(
            "  ours %.3f s (best %.3f, processor %.3f) %.0f MB: %.1f times faster by the medians, %.1f by the best, "
            "%.1f by processor time; %.2f of the memory\n",
            ours.seconds, ours.best, ours.processor, memory(ours), vtk.seconds / ours.seconds, vtk.best / ours.best,
            vtk.processor / ours.processor, memory(ours) / memory(vtk));
        std::printf("  surface alone %.3f s (best %.3f, processor %.3f) %.0f MB\n", surface.seconds, surface.best,
                    surface.processor, memory(surface));
        good = good && ours.good && surface.good;
    }
    for (const bool deflated : {false, true}) {
        const fs::path path = folder.path() / (deflated ? "deflated.cas.h5" : "plain.cas.h5");
        write_hdf5(path, n, deflated);
        const double nothing = bare_process();
        const long long cells = static_cast<long long>(n) * n * n;
        const long long bytes = read_bytes(path);
        const Cost plain = cost_of([&] { return read_bytes(path); }, bytes);
        const Cost library = cost_of([&] { return read_by_library(path); }, 0);
        const Cost ours = cost_of([&] { return read_ours(path, false); }, cells);
        const Cost surface = cost_of([&] { return read_ours(path, true); }, 6LL * n * n);
        const auto memory = [&](const Cost& cost) { return cost.megabytes - nothing; };
        const auto rate = [&](double seconds) { return static_cast<double>(bytes) / 1e6 / seconds; };
        std::printf(
            "HDF5, %s, %.0f MB: the library alone %.3f s (best %.3f, processor %.3f), the bytes out of the disk's "
            "cache %.3f s\n",
            deflated ? "deflated" : "plain", static_cast<double>(bytes) / 1e6, library.seconds, library.best,
            library.processor, plain.seconds);
        std::printf(
            "  ours %.3f s (best %.3f: %.0f MB/s, processor %.3f) %.0f MB: %.2f times the library's by the medians, "
            "%.2f by the best, %.2f by processor time\n",
            ours.seconds, ours.best, rate(ours.best), ours.processor, memory(ours), ours.seconds / library.seconds,
            ours.best / library.best, ours.processor / library.processor);
        std::printf("  surface alone %.3f s (best %.3f, processor %.3f) %.0f MB\n", surface.seconds, surface.best,
                    surface.processor, memory(surface));
        const Cost disk = cost_of([&] { return read_bytes(path); }, bytes, [&] { forget(path); });
        const Cost from_disk = cost_of([&] { return read_ours(path, false); }, cells, [&] { forget(path); });
        std::printf(
            "  from the disk: the bytes alone %.3f s (%.0f MB/s), ours %.3f s: %.2f times by the medians, %.2f by the "
            "best\n",
            disk.seconds, rate(disk.seconds), from_disk.seconds, from_disk.seconds / disk.seconds,
            from_disk.best / disk.best);
        good = good && ours.good && surface.good && library.good;
    }
    return good ? 0 : 1;
}
