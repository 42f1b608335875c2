#include <algorithm>
#include <cmath>
#include <limits>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/importers/fluent/fluent_legacy.h"
#include "postproc/importers/fluent/fluent_variables.h"
#include "postproc/importers/import_context.h"

namespace underbody::postproc {

namespace {

/// What a comment such as "SV_P, domain 1, wall zone 11, 240 faces:" says of the section that follows.
struct Announced {
    std::string variable;
    int domain = 1;
    std::string zone_type;
    long long zone = 0;
};

Announced announced(std::string_view comment) {
    Announced result;
    const std::size_t begin = comment.find("SV_");
    if (begin == std::string_view::npos) {
        return result;
    }
    const auto parts = core::split(comment.substr(begin), ',');
    result.variable = std::string(core::trimmed(parts[0]));
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const std::string_view part = core::trimmed(parts[i]);
        if (part.starts_with("domain ")) {
            result.domain = static_cast<int>(core::parse_integer(part.substr(7)).value_or(1));
        } else if (const std::size_t at = part.find(" zone "); at != std::string_view::npos) {
            result.zone_type = std::string(core::trimmed(part.substr(0, at)));
            result.zone = core::parse_integer(part.substr(at + 6)).value_or(0);
        }
    }
    return result;
}

/// Where a zone of the mesh has its ids.
struct ZoneRanges {
    bool cells = false;
    bool inner = false;
    bool hidden = false;  ///< no fluid acts on it
    std::vector<IdRange> ranges;

    [[nodiscard]] bool holds(std::uint64_t first, std::uint64_t last) const {
        return std::any_of(ranges.begin(), ranges.end(),
                           [&](const IdRange& r) { return first >= r.first && last <= r.last; });
    }
};

/// A zone may come in several sections; its values come in one.
void join_ranges(std::vector<IdRange>& ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const IdRange& a, const IdRange& b) { return a.first < b.first; });
    std::vector<IdRange> joined;
    for (const IdRange& range : ranges) {
        if (!joined.empty() && range.first == joined.back().last + 1) {
            joined.back().last = range.last;
        } else {
            joined.push_back(range);
        }
    }
    ranges = std::move(joined);
}

class DataReader {
public:
    DataReader(ByteStream& in, const FaceMesh& mesh, const ReadOptions& options, FluentSettings& settings,
               core::Problems& problems, core::Progress& progress)
        : in_(in),
          text_(in),
          mesh_(mesh),
          options_(options),
          settings_(settings),
          problems_(problems),
          progress_(progress) {
        for (const auto& block : mesh.cell_blocks) {
            auto& zone = zones_[block.zone];
            zone.cells = true;
            zone.ranges.push_back({block.first, block.first + block.count - 1});
        }
        for (const auto& block : mesh.face_blocks) {
            auto& zone = zones_[block.zone];
            zone.inner = is_inner_code(block.kind);
            zone.hidden = is_hidden_code(block.kind);
            zone.ranges.push_back({block.first, block.first + block.count - 1});
        }
        for (auto& [id, zone] : zones_) {
            join_ranges(zone.ranges);
            zone.hidden = zone.hidden || (!zone.cells && mesh.bounds_solids(id));
        }
    }

    std::vector<ValueBlock> read() {
        telling(
            [&] {
                text_.skip_byte_order_mark();
                while (text_.next() >= 0) {
                    section();
                }
                if (!sized_ && sections_ == 0) {
                    throw core::InputError("format", "there are no solution data in this file",
                                           {in_.name(), {}, {}, {}});
                }
            },
            [&] { return understood(); });
        if (odd_values_ > 0) {
            problems_.push_back(
                {core::Problem::Severity::warning,
                 core::counted(odd_values_, "value is", "values are") + " not finite: the solution has diverged",
                 {in_.name(), {}, {}, {}}});
        }
        mind_missing_pressure();
        for (const auto& section : listed_sections(skipped_)) {
            settings_.skipped.push_back(section + " of the data");
        }
        return std::move(values_);
    }

private:
    void section();
    void mind_missing_pressure();
    void grid_size();
    void solution(std::uint64_t index, std::size_t size);
    ValueBlock announced_block(const std::vector<std::uint64_t>& header, const Announced& said, std::size_t size);
    void values(ValueBlock& block, std::size_t size);
    void unknown(std::uint64_t index, bool binary);
    void check_zone(const ValueBlock& block, const Announced& said, const ZoneRanges& zone, std::uint64_t last) const;
    void keep(ValueBlock&& block);
    [[noreturn]] void other_case(const std::string& what) const {
        throw core::InputError("mismatch", "these data belong to another case than " + mesh_.file + ": " + what,
                               in_.place(), "give the case they were written with");
    }
    [[nodiscard]] std::string understood() const {
        std::string text = std::to_string(sections_) + " solution sections";
        if (!last_variable_.empty()) {
            text += ", the last of " + last_variable_;
        }
        return text;
    }

    ByteStream& in_;
    FluentText text_;
    const FaceMesh& mesh_;
    const ReadOptions& options_;
    FluentSettings& settings_;
    core::Problems& problems_;
    core::Progress& progress_;
    std::map<int, ZoneRanges> zones_;
    std::map<std::uint64_t, int> skipped_;
    std::vector<ValueBlock> values_;
    std::string comment_;
    std::string last_variable_;
    std::uint64_t sections_ = 0;
    std::uint64_t odd_values_ = 0;
    bool sized_ = false;
};

/// Data cut off between two sections look whole: boundary zones without pressure give them away.
void DataReader::mind_missing_pressure() {
    if (!wants_variable(options_, pressure_variable)) {
        return;
    }
    std::string without;
    for (const auto& [id, zone] : zones_) {
        const bool found = std::any_of(values_.begin(), values_.end(), [&, zone_id = id](const ValueBlock& block) {
            return block.zone == zone_id && block.variable == pressure_variable;
        });
        const ZoneLabel* label = mesh_.label(id);
        const bool solid = label != nullptr && (label->type == "solid" || label->type == "interface");
        if (!found && !solid && !zone.hidden && !zone.inner && !(zone.cells && options_.surfaces_only) &&
            !zone.ranges.empty()) {
            without += (without.empty() ? "" : ", ") + (label != nullptr ? label->name : std::to_string(id));
        }
    }
    if (!without.empty()) {
        problems_.push_back({core::Problem::Severity::warning,
                             "there is no pressure on zones " + without + ": are the data cut short?",
                             {in_.name(), {}, {}, {}}});
    }
}

void DataReader::section() {
    progress_.check();
    text_.set_section(0);
    text_.expect('(');
    const std::uint64_t index = text_.number(10);
    text_.set_section(index);
    switch (index) {
        case 0:
            comment_ = text_.comment();
            return;
        case 4:
            return text_.machine();
        case 33:
            return grid_size();
        case 37:
            settings_.variables.insert(
                0, text_.inside(std::size_t{16} << 20));  // the run knows its own time better than the case does
            return;
        case 300:
            return solution(index, 0);
        case 2300:
            return solution(index, 4);
        case 3300:
            return solution(index, 8);
        default:
            return unknown(index, index >= 2000 && index < 4000);
    }
}

void DataReader::grid_size() {
    const auto sizes = text_.numbers(10);
    text_.expect(')');
    if (sizes.size() < 3) {
        text_.fail("a grid size without three numbers");
    }
    sized_ = true;
    if (sizes[0] != mesh_.cells || sizes[2] != mesh_.nodes) {
        other_case("they are for " + std::to_string(sizes[0]) + " cells, " + std::to_string(sizes[1]) + " faces, " +
                   std::to_string(sizes[2]) + " nodes; the case has " + std::to_string(mesh_.cells) + ", " +
                   std::to_string(mesh_.faces) + ", " + std::to_string(mesh_.nodes));
    }
    if (sizes[1] != mesh_.faces) {
        // Some translators count faces otherwise; cells, nodes and the ids of each section still have to agree.
        problems_.push_back({core::Problem::Severity::warning,
                             "the data state " + std::to_string(sizes[1]) + " faces, the case " +
                                 std::to_string(mesh_.faces) + "; cells, nodes and zones agree",
                             in_.place()});
    }
}

void DataReader::check_zone(const ValueBlock& block, const Announced& said, const ZoneRanges& zone,
                            std::uint64_t last) const {
    if (!zone.holds(block.first, last)) {
        other_case(block.variable + " is given for ids " + std::to_string(block.first) + " to " + std::to_string(last) +
                   " of zone " + std::to_string(block.zone) + ", which has others");
    }
    const ZoneLabel* label = mesh_.label(block.zone);
    if (said.zone == block.zone && label != nullptr && !said.zone_type.empty()) {
        const bool said_cells = said.zone_type == "cell" || said.zone_type == "fluid" || said.zone_type == "solid";
        if (said_cells != zone.cells || (!said_cells && said.zone_type != label->type &&
                                         kind_of_type(said.zone_type) != kind_of_type(label->type))) {
            other_case("zone " + std::to_string(block.zone) + " is of type " + said.zone_type + " there and " +
                       label->type + " (" + label->name + ") here");
        }
    }
}

/// What the header of a section says of its values.
ValueBlock DataReader::announced_block(const std::vector<std::uint64_t>& header, const Announced& said,
                                       std::size_t size) {
    ValueBlock block;
    const auto small = [](std::uint64_t v) {
        return static_cast<int>(std::min<std::uint64_t>(v, std::numeric_limits<int>::max()));
    };
    block.zone = small(header[1]);
    block.variable = said.variable.empty() ? fluent_variable(small(header[0])) : said.variable;
    last_variable_ = block.variable + " on zone " + std::to_string(block.zone);
    block.phase = said.domain;
    block.first = header[5];
    const std::uint64_t last = header[6];
    const std::uint64_t components = header[2];
    if (block.first == 0 || last + 1 < block.first || components == 0 || components > 1024) {
        text_.fail("ids " + std::to_string(block.first) + " to " + std::to_string(last) + " with " +
                   std::to_string(components) + " components");
    }
    block.count = last + 1 - block.first;
    block.components = static_cast<int>(components);
    const std::uint64_t left = in_.most_left();
    if (block.count > left || block.count * components > left / std::max<std::size_t>(size, 1)) {
        text_.fail("the header announces " + std::to_string(block.count) + " x " + std::to_string(components) +
                   " values, but only " + std::to_string(left) + " bytes are left");
    }
    return block;
}

void DataReader::solution(std::uint64_t index, std::size_t size) {
    const auto header = text_.header(10, 7);
    // A comment speaks of the section behind it alone, and of its own zone.
    Announced said = announced(std::exchange(comment_, {}));
    if (said.zone != 0 && static_cast<std::uint64_t>(said.zone) != header[1]) {
        said = {};
    }
    ValueBlock block = announced_block(header, said, size);
    const std::uint64_t last = header[6];
    const std::uint64_t components = header[2];
    const auto zone = zones_.find(block.zone);
    const bool known = zone != zones_.end();
    if (block.count > 0 && known) {
        check_zone(block, said, zone->second, last);
    }
    // With surfaces alone, zones inside the mesh are not known here; their values are passed over.
    if (!known && !options_.surfaces_only && mesh_.label(block.zone) == nullptr) {
        other_case("zone " + std::to_string(block.zone) + " of " + block.variable + " is not there");
    }
    text_.expect('(');
    const bool wanted = known && !zone->second.inner && !(zone->second.cells && options_.surfaces_only) &&
                        block.count > 0 && wants_variable(options_, block.variable);
    if (wanted) {
        block.on_cells = zone->second.cells;
        block.values.grow_to(block.count * components);
        values(block, size);
    } else if (size == 0) {
        text_.skip_plain_body();
        ++sections_;
        return;
    } else {
        in_.skip(block.count * components * size);
    }
    if (size == 0) {
        text_.close_plain_body();
    } else {
        text_.close_binary_body(index);
    }
    ++sections_;
    if (wanted) {
        keep(std::move(block));
    }
}

void DataReader::keep(ValueBlock&& block) {
    const bool known = std::any_of(values_.begin(), values_.end(), [&](const ValueBlock& other) {
        return other.zone == block.zone && other.phase == block.phase && other.variable == block.variable &&
               other.first <= block.first + block.count - 1 && block.first <= other.first + other.count - 1;
    });
    if (known) {
        problems_.push_back({core::Problem::Severity::warning,
                             last_variable_ + " stands twice in the data: the first counts", in_.place()});
        return;
    }
    values_.push_back(std::move(block));
}

void DataReader::values(ValueBlock& block, std::size_t size) {
    double* out = block.values.data();
    const std::size_t count = block.values.size();
    if (size == 0) {
        text_.reals(out, count);
    } else {
        text_.binary_reals(out, count, size);
    }
    for (std::size_t i = 0; i < count; ++i) {
        odd_values_ += std::isfinite(out[i]) ? 0 : 1;
    }
}

void DataReader::unknown(std::uint64_t index, bool binary) {
    constexpr std::uint64_t residuals = 302;
    if (index % 1000 != residuals && index != 301) {
        ++skipped_[index];
    }
    text_.skip_section(index, binary);
}

}  // namespace

std::vector<ValueBlock> read_legacy_data(ByteStream& in, const FaceMesh& mesh, const ReadOptions& options,
                                         FluentSettings& settings, core::Problems& problems, core::Progress& progress) {
    return DataReader(in, mesh, options, settings, problems, progress).read();
}

}  // namespace underbody::postproc
