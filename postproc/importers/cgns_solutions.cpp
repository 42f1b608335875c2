// Steps in time, grids and solutions of a zone.
#include <cgnslib.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "postproc/importers/cgns_file.h"

namespace underbody::postproc {

Buffer<double> CgnsFile::points(const CgnsZone& zone) {
    double count = 1;
    const std::array<cgsize_t, 3> low = {1, 1, 1};
    std::array<cgsize_t, 3> high = {1, 1, 1};
    for (std::size_t k = 0; k < 3; ++k) {
        high[k] = static_cast<cgsize_t>(zone.nodes[k]);
        count *= static_cast<double>(std::max<cgsize_t>(0, high[k]));
    }
    check_room(zone, count);
    if (count < 1 || count > 2147483647.0) {
        fail(zone, "it has " + core::format_number(count) + " nodes");
    }
    const auto nodes = static_cast<std::size_t>(count);
    Buffer<double> points(3 * nodes);
    points.fill(0);
    Buffer<double> column(nodes);
    int coordinates = 0;
    ok(zone, cg_ncoords(file_, base_, zone.index, &coordinates), "coordinates");
    for (int c = 1; c <= coordinates; ++c) {
        std::array<char, 33> coordinate{};
        CGNS_ENUMT(DataType_t) type{};
        ok(zone, cg_coord_info(file_, base_, zone.index, c, &type, coordinate.data()), "coordinate");
        const std::string_view word(coordinate.data());
        const int axis = word.starts_with("Coordinate") && word.size() == 11 ? word[10] - 'X' : -1;
        if (axis < 0 || axis > 2) {
            fail(zone, "coordinates '" + std::string(word) + "' are not read (cylindrical and others)");
        }
        ok(zone, cg_coord_read(file_, base_, zone.index, coordinate.data(), CGNS_ENUMV(RealDouble), low.data(), high.data(),
                         column.data()),
           "coordinates");
        const double scale = scales_of(zone, "GridCoordinates_t", 1, c).length;
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!std::isfinite(column[i])) {
                fail(zone, "a coordinate that is not a number");
            }
            points[3 * i + static_cast<std::size_t>(axis)] = scale * column[i];
        }
    }
    return points;
}
void CgnsFile::read_times() {
    std::array<char, 33> name{};
    int steps = 0;
    int arrays = 0;
    if (cg_biter_read(file_, base_, name.data(), &steps) != CG_OK || steps < 1 || static_cast<std::uint64_t>(steps) > most_values_ ||
        cg_goto(file_, base_, "BaseIterativeData_t", 1, "end") != CG_OK || cg_narrays(&arrays) != CG_OK) {
        return;
    }
    for (int a = 1; a <= arrays; ++a) {
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        if (cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) == CG_OK && std::string_view(name.data()) == "TimeValues" && dimensions == 1 &&
            sizes[0] == steps) {
            times_.resize(static_cast<std::size_t>(steps));
            if (cg_array_read_as(a, CGNS_ENUMV(RealDouble), times_.data()) != CG_OK) {
                times_.clear();
            }
        }
    }
    step_ = times_.empty() ? 0 : times_.size() - 1;
}

/// Names of the solutions of a zone, one a step; empty where the zone does not say.
std::vector<std::string> CgnsFile::solutions_of_steps(const CgnsZone& zone) const {
    std::array<char, 33> name{};
    int arrays = 0;
    if (times_.empty() || cg_ziter_read(file_, base_, zone.index, name.data()) != CG_OK ||
        cg_goto(file_, base_, "Zone_t", zone.index, "ZoneIterativeData_t", 1, "end") != CG_OK || cg_narrays(&arrays) != CG_OK) {
        return {};
    }
    for (int a = 1; a <= arrays; ++a) {
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        const bool found = cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) == CG_OK && std::string_view(name.data()) == "FlowSolutionPointers";
        if (!found || type != CGNS_ENUMV(Character) || dimensions != 2 || sizes[0] != 32 || sizes[1] != static_cast<cgsize_t>(times_.size())) {
            continue;
        }
        std::string text(32 * times_.size(), ' ');
        if (cg_array_read(a, text.data()) != CG_OK) {
            return {};
        }
        std::vector<std::string> names;
        for (std::size_t step = 0; step < times_.size(); ++step) {
            const std::string_view padded = std::string_view(text).substr(32 * step, 32);
            names.emplace_back(core::trimmed(padded.substr(0, padded.find('\0'))));
        }
        return names;
    }
    return {};
}

std::vector<PartValues> CgnsFile::solutions(const CgnsZone& zone, const ReadOptions& options, core::Progress& progress, int& left) {
    std::vector<PartValues> result;
    const std::vector<std::string> steps = solutions_of_steps(zone);
    int count = 0;
    if (cg_nsols(file_, base_, zone.index, &count) != CG_OK) {
        return result;
    }
    for (int s = 1; s <= count; ++s) {
        std::array<char, 33> solution{};
        CGNS_ENUMT(GridLocation_t) location{};
        int fields = 0;
        if (cg_sol_info(file_, base_, zone.index, s, solution.data(), &location) != CG_OK ||
            cg_nfields(file_, base_, zone.index, s, &fields) != CG_OK ||
            (location != CGNS_ENUMV(Vertex) && location != CGNS_ENUMV(CellCenter))) {
            continue;
        }
        const bool of_a_step = std::find(steps.begin(), steps.end(), solution.data()) != steps.end();
        if (of_a_step && steps[step_] != solution.data()) {
            ++left;
            continue;
        }
        const bool nodal = location == CGNS_ENUMV(Vertex);
        std::array<cgsize_t, 3> low = {1, 1, 1};
        std::array<cgsize_t, 3> high = {1, 1, 1};
        double size = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            high[k] = static_cast<cgsize_t>(nodal ? zone.nodes[k] : zone.cells[k]);
            size *= static_cast<double>(high[k]);
        }
        check_room(zone, size);
        for (int f = 1; f <= fields; ++f) {
            progress.check();
            std::array<char, 33> name{};
            CGNS_ENUMT(DataType_t) type{};
            ok(zone, cg_field_info(file_, base_, zone.index, s, f, &type, name.data()), "field");
            const CanonicalName canonical = canonical_name(name.data());
            const auto component = vector_component(canonical.name);
            if (!options.arrays.empty() && !matches_any(options.arrays, name.data()) &&
                !matches_any(options.arrays, canonical.name) &&
                !(component && matches_any(options.arrays, component->vector))) {
                continue;
            }
            PartValues values{name.data(), nodal, 1, Buffer<double>(static_cast<std::size_t>(size))};
            ok(zone, cg_field_read(file_, base_, zone.index, s, name.data(), CGNS_ENUMV(RealDouble), low.data(), high.data(),
                             values.values.data()),
               "field");
            if (const double scale = scales_of(zone, "FlowSolution_t", s, f).to_si(canonical.unit); scale != 1) {
                converted_[name.data()] = core::format_number(scale) + " " + canonical.unit;
                std::for_each(values.values.begin(), values.values.end(), [&](double& value) { value *= scale; });
            }
            const auto before = std::find_if(result.begin(), result.end(), [&](const PartValues& v) { return v.variable == values.variable && v.on_nodes == nodal; });
            if (before != result.end()) {
                ++left;
                *before = std::move(values);
            } else {
                result.push_back(std::move(values));
            }
        }
    }
    return result;
}

}  // namespace underbody::postproc
