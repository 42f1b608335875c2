// Steps in time: which base, zones, grid and solutions belong to the one that is wanted.
#include <cgnslib.h>

#include <algorithm>

#include "core/text.h"
#include "postproc/importers/cgns/cgns_file.h"
#include "postproc/importers/mesh/steps.h"

namespace underbody::postproc {

CgnsFile::Steps CgnsFile::steps_of_base(int base) const {
    Steps steps;
    std::array<char, 33> name{};
    int arrays = 0;
    if (cg_biter_read(file_, base, name.data(), &steps.count) != CG_OK || steps.count < 1 ||
        static_cast<std::uint64_t>(steps.count) > most_values_ ||
        cg_goto(file_, base, "BaseIterativeData_t", 1, "end") != CG_OK || cg_narrays(&arrays) != CG_OK) {
        return {};
    }
    for (int a = 1; a <= arrays; ++a) {
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        if (cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) == CG_OK &&
            std::string_view(name.data()) == "TimeValues" && dimensions == 1 && sizes[0] == steps.count) {
            steps.times.resize(static_cast<std::size_t>(steps.count));
            if (cg_array_read_as(a, CGNS_ENUMV(RealDouble), steps.times.data()) != CG_OK) {
                steps.times.clear();
            }
        }
    }
    return steps;
}

/// The base and the step of the time asked for; without one the last base, or the latest of those that state times.
/// Where a base is asked for, all this is of that one alone.
void CgnsFile::choose_step(std::optional<double> time, const std::string& asked) {
    const int only = asked.empty() ? 0 : base_called(asked);
    std::vector<Steps> bases;
    std::vector<std::pair<int, std::size_t>> places;  // base and step of each time
    for (int base = 1; base <= bases_; ++base) {
        bases.push_back(only == 0 || only == base ? steps_of_base(base) : Steps{});
        for (std::size_t step = 0; step < bases.back().times.size(); ++step) {
            times_.push_back(bases.back().times[step]);
            places.emplace_back(base, step);
        }
    }
    base_ = only == 0 ? bases_ : only;
    const Steps& last = bases[static_cast<std::size_t>(base_ - 1)];
    steps_ = static_cast<std::size_t>(last.count);
    step_ = steps_ > 0 ? steps_ - 1 : 0;
    time_asked_ = time.has_value();
    base_per_step_ =
        std::count_if(bases.begin(), bases.end(), [](const Steps& steps) { return !steps.times.empty(); }) > 1;
    if (time || base_per_step_ || !last.times.empty()) {
        const auto latest = static_cast<std::size_t>(std::max_element(times_.begin(), times_.end()) - times_.begin());
        const std::size_t place = time ? step_at(times_, *time, name_) : base_per_step_ ? latest : times_.size() - 1;
        std::tie(base_, step_) = places[place];
        steps_ = static_cast<std::size_t>(bases[static_cast<std::size_t>(base_ - 1)].count);
        time_ = times_[place];
    }
}

/// The names in an array of characters at the library's place ("FlowSolutionPointers"), those of the steps one behind
/// the other; empty when there is none, or one that does not fit the number of steps.
std::vector<std::string> CgnsFile::names_by_step(std::string_view array) const {
    int arrays = 0;
    if (steps_ == 0 || cg_narrays(&arrays) != CG_OK) {
        return {};
    }
    for (int a = 1; a <= arrays; ++a) {
        std::array<char, 33> name{};
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        const bool found =
            cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) == CG_OK && array == name.data();
        if (!found || type != CGNS_ENUMV(Character) || dimensions < 2 || dimensions > 3 || sizes[0] != 32 ||
            sizes[1] < 1 || static_cast<std::size_t>(sizes[static_cast<std::size_t>(dimensions - 1)]) != steps_) {
            continue;
        }
        const double count = static_cast<double>(steps_) * (dimensions == 3 ? sizes[1] : 1);
        if (count * 32 > static_cast<double>(most_values_)) {
            fail("'" + std::string(array) + "' claims " + core::format_number(count) + " names but the file has " +
                 std::to_string(bytes_) + " bytes");
        }
        std::string text(32 * static_cast<std::size_t>(count), ' ');
        std::vector<std::string> names;
        if (cg_array_read(a, text.data()) == CG_OK) {
            for (std::size_t at = 0; at < text.size(); at += 32) {
                const std::string_view padded = std::string_view(text).substr(at, 32);
                const std::string_view one = core::trimmed(padded.substr(0, padded.find('\0')));
                names.emplace_back(one.substr(one.rfind('/') + 1));  // some write the path
            }
        }
        return names;
    }
    return {};
}

/// Is there a thing of this name at a step?
bool CgnsFile::names_something(std::string_view pointer) { return !pointer.empty() && pointer != "Null"; }

void CgnsFile::find_zones_of_step() {
    int count = 0;
    if (cg_nzones(file_, base_, &count) != CG_OK) {
        fail(std::string("zones: ") + cg_get_error());
    }
    std::vector<std::string> names;
    if (cg_goto(file_, base_, "BaseIterativeData_t", 1, "end") == CG_OK) {
        names = names_by_step("ZonePointers");
    }
    const std::size_t each = names.empty() ? 0 : names.size() / steps_;
    zones_by_step_ = each > 0;
    const auto first = names.begin() + static_cast<std::ptrdiff_t>(each * step_);
    for (int index = 1; index <= count; ++index) {
        if (!zones_by_step_ || std::find(first, first + static_cast<std::ptrdiff_t>(each), zone(index).name) !=
                                   first + static_cast<std::ptrdiff_t>(each)) {
            zones_.push_back(index);
        }
    }
    if (zones_by_step_ && static_cast<std::ptrdiff_t>(zones_.size()) !=
                              std::count_if(first, first + static_cast<std::ptrdiff_t>(each), names_something)) {
        fail("step " + std::to_string(step_ + 1) + " names zones that are not there");
    }
}

/// Of each step's arrays with these names, those of the zone.
std::vector<std::vector<std::string>> CgnsFile::pointers(const CgnsZone& zone,
                                                         const std::vector<std::string_view>& arrays) const {
    std::vector<std::vector<std::string>> by_step;
    std::array<char, 33> name{};
    for (const auto array : arrays) {
        if (cg_ziter_read(file_, base_, zone.index, name.data()) != CG_OK ||
            cg_goto(file_, base_, "Zone_t", zone.index, "ZoneIterativeData_t", 1, "end") != CG_OK) {
            return {};
        }
        const std::vector<std::string> names = names_by_step(array);
        for (std::size_t step = 0; names.size() == steps_ && step < steps_; ++step) {
            by_step.resize(steps_);
            by_step[step].push_back(names[step]);
        }
    }
    return by_step;
}

/// The number of the grid that a zone has at the step.
int CgnsFile::grid_of_step(const CgnsZone& zone) {
    int grids = 0;
    ok(zone, cg_ngrids(file_, base_, zone.index, &grids), "grids");
    const auto by_step = pointers(zone, {"GridCoordinatesPointers"});
    std::string wanted = "GridCoordinates";
    if (!by_step.empty() && names_something(by_step[step_].front())) {
        wanted = by_step[step_].front();
    } else if (by_step.empty() && grids > 1) {
        if (time_asked_) {
            refuse_time("zone '" + zone.name + "' has " + std::to_string(grids) +
                        " grids and does not say of which times they are (GridCoordinatesPointers)");
        }
        warn("zone '" + zone.name + "' has " + std::to_string(grids) +
             " grids and does not say of which times they are: the first is read");
    }
    for (int grid = 1; grid <= grids; ++grid) {
        std::array<char, 33> name{};
        if (cg_grid_read(file_, base_, zone.index, grid, name.data()) == CG_OK && wanted == name.data()) {
            return grid;
        }
    }
    fail(zone, grids == 0 ? "it has no coordinates" : "there is no grid '" + wanted + "' in it");
}

void CgnsFile::refuse_time(const std::string& why) const {
    throw core::InputError("range", why + ": what belongs to the time asked for cannot be told", {name_, {}, {}, {}},
                           "leave option 'time' away");
}

}  // namespace underbody::postproc
