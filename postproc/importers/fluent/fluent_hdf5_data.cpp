#include <algorithm>
#include <iterator>

#include "core/text.h"
#include "postproc/importers/fluent/fluent_hdf5.h"
#include "postproc/importers/fluent/fluent_variables.h"
#include "postproc/importers/hdf5/hdf5_file.h"
#include "postproc/importers/hdf5/hdf5_rows.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

std::string number(std::uint64_t value) { return std::to_string(value); }

/// Values of a .dat.h5 for the zones that the mesh has.
class DataReader {
public:
    DataReader(const fs::path& path, const FaceMesh& mesh, const ReadOptions& options, core::Progress& progress)
        : file_(path), rows_(file_), mesh_(mesh), options_(options), progress_(progress) {}

    std::vector<ValueBlock> read(FluentSettings& settings, core::Problems& problems);
    /// Of the first phase, the variables asked for.
    void add_cells(std::vector<ValueBlock>& values);

private:
    void read_variable(const std::string& group, const std::string& variable, bool on_cells, int phase);
    /// Notes what is wanted of it to be read.
    void keep(const std::string& path, ValueBlock&& whole);
    [[nodiscard]] std::uint64_t last_fluid_cell() const;
    [[noreturn]] void other_case(const std::string& what) const {
        throw core::InputError("mismatch", "these data belong to another case than " + mesh_.file + ": " + what,
                               {file_.name(), {}, {}, {}}, "give the case they were written with");
    }

    Hdf5File file_;
    Hdf5Rows rows_;
    const FaceMesh& mesh_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::vector<ValueBlock> values_;
    std::uint64_t most_cell_ = 0;
    bool any_ = false;
};

std::vector<ValueBlock> DataReader::read(FluentSettings& settings, core::Problems& problems) {
    const core::Place place{file_.name(), {}, {}, {}};
    for (const auto& phase : file_.children("/results/1")) {
        if (!phase.starts_with("phase-")) {
            continue;
        }
        const auto index = static_cast<int>(core::parse_integer(phase.substr(6)).value_or(1));
        for (const bool on_cells : {true, false}) {
            const std::string group = "/results/1/" + phase + (on_cells ? "/cells" : "/faces");
            for (const auto& variable : file_.children(group)) {
                if (variable != "fields") {
                    progress_.check();
                    read_variable(group + "/" + variable, variable, on_cells, index);
                }
            }
        }
    }
    if (!any_) {
        throw core::InputError("format", "there are no solution data in this file", place);
    }
    if (most_cell_ > 0 && most_cell_ < last_fluid_cell() && mesh_.hidden_cells.empty()) {
        other_case("its cells end at " + number(most_cell_) + ", the case has " + number(mesh_.cells));
    }
    rows_.read(progress_);
    settings.variables.insert(
        0, file_.text("/settings/Data Variables"));  // the run knows its own time better than the case does
    const std::string named = file_name_in(file_.text("/settings/Case File"));
    const std::string ours = fs::path(mesh_.file).filename().string();
    if (!named.empty() && named != ours) {
        problems.push_back(
            {core::Problem::Severity::note,
             "the data say they were written with '" + named + "'; counts and ids agree with '" + ours + "'", place});
    }
    return std::move(values_);
}

void DataReader::add_cells(std::vector<ValueBlock>& values) {
    const std::string group = "/results/1/phase-1/cells";
    for (const auto& variable : file_.children(group)) {
        if (variable != "fields" && wants_variable(options_, variable)) {
            read_variable(group + "/" + variable, variable, true, 1);
        }
    }
    rows_.read(progress_);
    std::move(values_.begin(), values_.end(), std::back_inserter(values));
}

/// A solid without an energy equation has no values at all.
std::uint64_t DataReader::last_fluid_cell() const {
    std::uint64_t last = 0;
    for (const auto& block : mesh_.cell_blocks) {
        const ZoneLabel* label = mesh_.label(block.zone);
        if (label == nullptr || label->type != "solid") {
            last = std::max(last, block.first + block.count - 1);
        }
    }
    return last;
}

void DataReader::read_variable(const std::string& group, const std::string& variable, bool on_cells, int phase) {
    for (const auto& child : file_.children(group)) {
        const std::string path = group + "/" + child;
        const auto first = file_.attribute(path, "minId");
        const auto last = file_.attribute(path, "maxId");
        const auto shape = file_.shape(path);
        if (!first || !last || shape.empty()) {
            continue;
        }
        any_ = true;
        const std::uint64_t limit = on_cells ? mesh_.cells : mesh_.faces;
        if (*first < 1 || static_cast<std::uint64_t>(*last) > limit || *last + 1 < *first) {
            other_case(path + " has ids " + std::to_string(*first) + " to " + std::to_string(*last) +
                       ", the case has " + number(limit) + (on_cells ? " cells" : " faces"));
        }
        most_cell_ = on_cells ? std::max(most_cell_, static_cast<std::uint64_t>(*last)) : most_cell_;
        if ((on_cells && options_.surfaces_only) || !wants_variable(options_, variable)) {
            continue;
        }
        ValueBlock block;
        block.variable = variable;
        block.on_cells = on_cells;
        block.phase = phase;
        block.first = static_cast<std::uint64_t>(*first);
        block.count = static_cast<std::uint64_t>(*last - *first + 1);
        block.components = shape.size() > 1 ? static_cast<int>(std::min<std::uint64_t>(shape[1], 1024)) : 1;
        if (shape[0] != block.count || (shape.size() > 1 && (shape[1] > 1024 || shape[1] == 0))) {
            throw core::InputError("format", path + ": its size does not fit its ids", {file_.name(), {}, {}, {}});
        }
        keep(path, std::move(block));
    }
}

/// On faces the inside of the mesh is by far the most and nobody looks at it: only the zones' shares are read.
void DataReader::keep(const std::string& path, ValueBlock&& whole) {
    const auto n = static_cast<std::size_t>(whole.components);
    (void)file_.backed_shape(path);
    if (whole.on_cells) {
        whole.values.grow_to(whole.count * n);
        rows_.add(path, 0, whole.count, whole.values.data());
        values_.push_back(std::move(whole));
        return;
    }
    for (const auto& zone : mesh_.face_blocks) {
        const std::uint64_t from = std::max(whole.first, zone.first);
        const std::uint64_t to = std::min(whole.first + whole.count, zone.first + zone.count);
        if (is_inner_code(zone.kind) || from >= to) {
            continue;
        }
        ValueBlock part;
        part.variable = whole.variable;
        part.zone = zone.zone;
        part.phase = whole.phase;
        part.first = from;
        part.count = to - from;
        part.components = whole.components;
        part.values.grow_to(part.count * n);
        rows_.add(path, from - whole.first, part.count, part.values.data());
        values_.push_back(std::move(part));
    }
}

}  // namespace

std::vector<ValueBlock> read_hdf5_data(const fs::path& path, const FaceMesh& mesh, const ReadOptions& options,
                                       FluentSettings& settings, core::Problems& problems, core::Progress& progress) {
    return DataReader(path, mesh, options, progress).read(settings, problems);
}

void add_hdf5_cells(const fs::path& path, const FaceMesh& mesh, const ReadOptions& options,
                    std::vector<ValueBlock>& values, core::Progress& progress) {
    DataReader(path, mesh, options, progress).add_cells(values);
}

std::string file_name_in(const std::string& path) {
    const std::string text(core::trimmed(path));
    return text.substr(text.find_last_of("/\\") + 1);
}

}  // namespace underbody::postproc
