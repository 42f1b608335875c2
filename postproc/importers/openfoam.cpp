// OpenFOAM cases: the faces of polyMesh with the two cells beside them, the fields of one time, patches as surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/face_mesh.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/openfoam_input.h"
#include "postproc/importers/steps.h"
#include "postproc/importers/understood.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

constexpr int volume_zone = 1;
constexpr int inner_code = 2;
constexpr int patch_code = 4;

struct Patch {
    std::string name;
    std::string type;
    std::uint64_t start = 0;
    std::uint64_t count = 0;
};

/// One folder with polyMesh and times: the whole case, or the share of one processor.
struct Piece {
    fs::path folder;
    std::vector<Patch> patches;
    std::uint64_t first_face = 0;  ///< ids from 0 in the whole mesh
    std::uint64_t first_cell = 0;
    std::uint64_t cells = 0;
    std::vector<std::size_t> blocks;  ///< of the mesh, one a patch
};

bool is_folder(const fs::path& path) {
    std::error_code error;
    return fs::is_directory(path, error);
}

/// constant/polyMesh, or processor0/constant/polyMesh.
bool is_case(const fs::path& folder) {
    return is_folder(folder / "constant" / "polyMesh") || is_folder(folder / "processor0" / "constant" / "polyMesh");
}

/// The case that a path stands for: its folder, its .foam file, its controlDict.
fs::path case_folder(const fs::path& path) {
    const fs::path whole = fs::absolute(path).lexically_normal();
    for (const fs::path& folder : {path, path.parent_path(), whole.parent_path().parent_path()}) {
        if (!folder.empty() && is_case(folder)) {
            return folder;
        }
    }
    return is_case(whole.parent_path()) ? whole.parent_path() : fs::path();
}

/// Folders whose names are numbers, in their order.
std::vector<std::pair<double, fs::path>> times_in(const fs::path& folder) {
    std::vector<std::pair<double, fs::path>> times;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const auto time = core::parse_number(entry.path().filename().string());
        if (time && std::isfinite(*time) && entry.is_directory(error)) {
            times.emplace_back(*time, entry.path());
        }
    }
    std::sort(times.begin(), times.end());
    return times;
}

/// "0 2 -2 0 0 0 0" as a unit.
std::string unit_of(const std::vector<double>& powers) {
    constexpr std::array bases = {"kg", "m", "s", "K", "mol", "A", "cd"};
    std::string unit;
    for (std::size_t i = 0; i < std::min(powers.size(), bases.size()); ++i) {
        if (powers[i] != 0) {
            unit += (unit.empty() ? "" : " ") + std::string(bases[i]) +
                    (powers[i] == 1 ? "" : "^" + core::format_number(powers[i]));
        }
    }
    return unit.empty() ? "1" : unit;
}

/// The values that a field file gives to one patch.
struct PatchValues {
    std::string type;
    std::vector<double> uniform;
    Buffer<double> list;
};

class Reader {
public:
    Reader(const fs::path& path, const ReadOptions& options, core::Progress& progress)
        : path_(path), folder_(case_folder(path)), options_(options), progress_(progress) {}

    Field read();
    [[nodiscard]] std::string understood() const;

private:
    [[noreturn]] static void refuse(const fs::path& file, const std::string& what) {
        throw core::InputError("format", what, {file.string(), {}, {}, {}}, "the case is damaged or incomplete");
    }
    void find_pieces();
    void choose_time();
    void read_mesh(Piece& piece);
    [[nodiscard]] fs::path mesh_file(const Piece& piece, const std::string& name) const;
    void read_points(const Piece& piece, std::vector<std::uint32_t>& place);
    void read_patches(Piece& piece, std::uint64_t inner, std::uint64_t faces);
    void cut_faces(Piece& piece, const Buffer<std::uint32_t>& offsets, const Buffer<std::uint32_t>& nodes,
                   const Buffer<std::uint32_t>& owner, const Buffer<std::uint32_t>& neighbour,
                   const std::vector<std::uint32_t>& place);
    int zone_of(const Patch& patch);
    void read_fields(const Piece& piece);
    void read_field(const Piece& piece, const fs::path& file);
    void add_patch(const Piece& piece, std::size_t patch, const ValueBlock& like, const PatchValues* given,
                   const Buffer<double>& inner);
    void name_quantity(ValueBlock& block, const std::vector<double>& dimensions) const;
    PatchValues read_patch_values(FoamInput& in, std::size_t components) const;
    void finish(Field& field) const;

    fs::path path_;
    fs::path folder_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::vector<Piece> pieces_;
    std::vector<double> times_;
    std::string time_name_;
    FaceMesh mesh_;
    std::map<std::string, int> zones_;
    std::vector<ValueBlock> values_;
    core::Problems problems_;
    bool kinematic_ = false;
};

std::string Reader::understood() const {
    std::string text = std::to_string(mesh_.nodes) + " nodes, " + std::to_string(mesh_.faces) + " faces, " +
                       std::to_string(mesh_.cells) + " cells";
    for (const auto& label : mesh_.labels) {
        text += (&label == &mesh_.labels.front() ? ", patches " : ", ") + label.name;
    }
    if (!values_.empty()) {
        text += "; the last field " + values_.back().variable;
    }
    return text;
}

void Reader::find_pieces() {
    if (is_folder(folder_ / "constant" / "polyMesh") &&
        (!is_folder(folder_ / "processor0") || !times_in(folder_).empty())) {
        // A case that was put together again, or never taken apart: unless only its processors went on in time.
        const auto own = times_in(folder_);
        const auto split = times_in(folder_ / "processor0");
        if (split.empty() || (!own.empty() && own.back().first >= split.back().first)) {
            pieces_.push_back({folder_, {}, 0, 0, 0, {}});
            return;
        }
    }
    for (int p = 0; is_folder(folder_ / ("processor" + std::to_string(p))); ++p) {
        pieces_.push_back({folder_ / ("processor" + std::to_string(p)), {}, 0, 0, 0, {}});
    }
    if (pieces_.empty()) {
        pieces_.push_back({folder_, {}, 0, 0, 0, {}});
    }
}

void Reader::choose_time() {
    const auto times = times_in(pieces_.front().folder);
    for (const auto& [time, folder] : times) {
        times_.push_back(time);
    }
    if (times.empty()) {
        problems_.push_back(
            {core::Problem::Severity::note, "the case has no times: only its mesh is read", {folder_.string(), {}, {}, {}}});
        return;
    }
    const std::size_t chosen = options_.time ? step_at(times_, *options_.time, folder_.string()) : times.size() - 1;
    time_name_ = times[chosen].second.filename().string();
    if (times.size() > 1 && !options_.time) {
        problems_.push_back({core::Problem::Severity::note,
                             "the last of " + std::to_string(times.size()) + " times is read (" + time_name_ + ")",
                             {folder_.string(), {}, {}, {}}});
    }
}

/// Of the chosen time or the last one before it that has it (moving meshes), else of constant.
fs::path Reader::mesh_file(const Piece& piece, const std::string& name) const {
    const auto times = times_in(piece.folder);
    const auto chosen = core::parse_number(time_name_);
    for (auto it = times.rbegin(); it != times.rend(); ++it) {
        const fs::path file = it->second / "polyMesh" / name;
        if (chosen && it->first <= *chosen && FoamInput::exists(file)) {
            return file;
        }
    }
    const fs::path file = piece.folder / "constant" / "polyMesh" / name;
    if (!FoamInput::exists(file)) {
        refuse(file, "the mesh has no file '" + name + "'");
    }
    return file;
}

/// Points of processors go to the places that the whole case had, when these are known.
void Reader::read_points(const Piece& piece, std::vector<std::uint32_t>& place) {
    FoamInput in(mesh_file(piece, "points"));
    Buffer<double> points = in.reals(3);
    const std::uint64_t count = points.size() / 3;
    for (const double x : points) {
        if (!std::isfinite(x)) {
            in.fail("a coordinate that is not a number");
        }
    }
    const fs::path addresses = piece.folder / "constant" / "polyMesh" / "pointProcAddressing";
    if (pieces_.size() == 1) {
        mesh_.points = std::move(points);
        mesh_.nodes = count;
        return;
    }
    place.resize(count);
    std::uint64_t last = mesh_.nodes;
    if (FoamInput::exists(addresses)) {
        FoamInput list(addresses);
        const auto numbers = list.labels();
        if (numbers.size() != count) {
            list.fail("addresses for " + std::to_string(numbers.size()) + " points, there are " + std::to_string(count));
        }
        for (std::size_t i = 0; i < count; ++i) {
            place[i] = numbers[i];
            last = std::max<std::uint64_t>(last, std::uint64_t{numbers[i]} + 1);
        }
        // A damaged list must not ask for memory without end.
        if (last > 64 * (mesh_.nodes + count) + 1024) {
            list.fail("a point with the number " + std::to_string(last - 1));
        }
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            place[i] = static_cast<std::uint32_t>(last + i);
        }
        last += count;
    }
    const std::size_t before = mesh_.points.size();
    mesh_.points.grow_to(3 * last);
    std::fill(mesh_.points.begin() + static_cast<std::ptrdiff_t>(before), mesh_.points.end(), 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        std::copy_n(points.data() + 3 * i, 3, mesh_.points.data() + 3 * static_cast<std::size_t>(place[i]));
    }
    mesh_.nodes = last;
}

void Reader::read_patches(Piece& piece, std::uint64_t inner, std::uint64_t faces) {
    FoamInput in(mesh_file(piece, "boundary"));
    if (!in.accept('(')) {
        in.count();
        in.expect("(");
    }
    while (!in.accept(')')) {
        Patch patch;
        patch.name = in.token();
        in.expect("{");
        for (std::string key = in.token(); key != "}"; key = in.token()) {
            if (key.empty()) {
                in.fail("the file ends within patch '" + patch.name + "'");
            }
            if (key == "type") {
                patch.type = in.token();
                in.expect(";");
            } else if (key == "nFaces" || key == "startFace") {
                (key == "nFaces" ? patch.count : patch.start) = in.count();
                in.expect(";");
            } else {
                in.skip_entry();
            }
        }
        piece.patches.push_back(std::move(patch));
    }
    std::uint64_t next = inner;
    for (const auto& patch : piece.patches) {
        if (patch.start != next || patch.count > faces - next) {
            in.fail("patch '" + patch.name + "' has " + std::to_string(patch.count) + " faces from " +
                    std::to_string(patch.start) + " on; it should begin at " + std::to_string(next) + " of " +
                    std::to_string(faces));
        }
        next += patch.count;
    }
    if (next != faces) {
        in.fail("the patches end at face " + std::to_string(next) + ", there are " + std::to_string(faces));
    }
}

int Reader::zone_of(const Patch& patch) {
    const auto [found, fresh] = zones_.try_emplace(patch.name, volume_zone + 1 + static_cast<int>(zones_.size()));
    if (fresh) {
        mesh_.labels.push_back({found->second, patch.type, patch.name});
    }
    return found->second;
}

/// OpenFOAM's normals point from owner to neighbour; turned round they point into the owner, as a FaceMesh wants.
void Reader::cut_faces(Piece& piece, const Buffer<std::uint32_t>& offsets, const Buffer<std::uint32_t>& nodes,
                       const Buffer<std::uint32_t>& owner, const Buffer<std::uint32_t>& neighbour,
                       const std::vector<std::uint32_t>& place) {
    const auto add = [&](int zone, int kind, std::uint64_t first, std::uint64_t count) {
        FaceBlock block;
        block.zone = zone;
        block.kind = kind;
        block.first = piece.first_face + first + 1;
        block.count = count;
        block.offsets.grow_to(count + 1);
        block.nodes.grow_to(offsets[first + count] - offsets[first]);
        block.c0.grow_to(count);
        block.c1.grow_to(first < neighbour.size() ? count : 0);
        std::uint32_t at = 0;
        for (std::uint64_t i = 0; i < count; ++i) {
            block.offsets[i] = at;
            for (std::uint32_t k = offsets[first + i + 1]; k > offsets[first + i]; --k) {
                const std::uint32_t node = nodes[k - 1];
                if (!place.empty() && node >= place.size()) {
                    refuse(mesh_.file, "face " + std::to_string(first + i) + " names point " + std::to_string(node) +
                                           " of " + std::to_string(place.size()));
                }
                block.nodes[at++] = (place.empty() ? node : place[node]) + 1;
            }
            block.c0[i] = static_cast<std::uint32_t>(piece.first_cell + owner[first + i] + 1);
            if (!block.c1.empty()) {
                block.c1[i] = static_cast<std::uint32_t>(piece.first_cell + neighbour[first + i] + 1);
            }
        }
        block.offsets[count] = at;
        mesh_.face_blocks.push_back(std::move(block));
    };
    if (neighbour.size() > 0 && !options_.surfaces_only) {
        add(0, inner_code, 0, neighbour.size());
    }
    for (const auto& patch : piece.patches) {
        // Faces between processors are inside the mesh.
        const bool inside = patch.type.starts_with("processor");
        piece.blocks.push_back(mesh_.face_blocks.size());
        add(inside ? 0 : zone_of(patch), inside ? inner_code : patch_code, patch.start, patch.count);
    }
}

void Reader::read_mesh(Piece& piece) {
    mesh_.file = (piece.folder / "constant" / "polyMesh").string();
    std::vector<std::uint32_t> place;
    read_points(piece, place);
    progress_.check();
    Buffer<std::uint32_t> offsets;
    Buffer<std::uint32_t> nodes;
    FoamInput faces_file(mesh_file(piece, "faces"));
    faces_file.faces(offsets, nodes);
    const std::uint64_t faces = offsets.empty() ? 0 : offsets.size() - 1;
    FoamInput owner_file(mesh_file(piece, "owner"));
    const auto owner = owner_file.labels();
    FoamInput neighbour_file(mesh_file(piece, "neighbour"));
    const auto neighbour = neighbour_file.labels();
    if (owner.size() != faces || neighbour.size() > faces) {
        owner_file.fail("there are " + std::to_string(faces) + " faces, " + std::to_string(owner.size()) + " owners and " +
                        std::to_string(neighbour.size()) + " neighbours");
    }
    piece.first_face = mesh_.faces;
    piece.first_cell = mesh_.cells;
    for (const auto* list : {&owner, &neighbour}) {
        for (const std::uint32_t cell : *list) {
            piece.cells = std::max<std::uint64_t>(piece.cells, std::uint64_t{cell} + 1);
        }
    }
    if (piece.cells > faces) {  // a cell has four faces at least, each with two cells at most
        owner_file.fail("a face names cell " + std::to_string(piece.cells - 1) + ", more than the " + std::to_string(faces) +
                        " faces can enclose");
    }
    read_patches(piece, neighbour.size(), faces);
    cut_faces(piece, offsets, nodes, owner, neighbour, place);
    mesh_.faces += faces;
    mesh_.cells += piece.cells;
}

/// What the numbers are, out of the dimensions that the file states.
void Reader::name_quantity(ValueBlock& block, const std::vector<double>& dimensions) const {
    const CanonicalName canonical = canonical_name(block.variable);
    const std::string unit = unit_of(dimensions);
    block.canonical = canonical.name;
    block.unit = canonical.unit.empty() ? core::si_unit(unit) : canonical.unit;
    if (canonical.unit.empty() || core::same_dimension(unit, canonical.unit)) {
        return;
    }
    const bool over_density = unit == "m^2 s^-2";
    const bool known = over_density && (canonical.name == "pressure" || canonical.name == "wall_shear");
    block.canonical = known ? "kinematic_" + canonical.name : block.variable;
    block.unit = known ? "m^2/s^2" : core::si_unit(unit);
}

PatchValues Reader::read_patch_values(FoamInput& in, std::size_t components) const {
    PatchValues values;
    in.expect("{");
    for (std::string key = in.token(); key != "}"; key = in.token()) {
        if (key.empty()) {
            in.fail("the file ends within a patch");
        }
        if (key == "type") {
            values.type = in.token();
            in.expect(";");
        } else if (key == "value") {
            const std::string how = in.token();
            if (how == "uniform") {
                values.uniform = in.value(components);
                in.expect(";");
            } else if (how == "nonuniform") {
                in.token();  // List<...>
                values.list = in.reals(components);
                in.expect(";");
            } else if (how != ";") {
                in.skip_entry();  // "$internalField"
            }
        } else if (!key.starts_with("#")) {
            in.skip_entry();
        }
    }
    return values;
}

/// Boundary conditions that state no value take it from the cell beside the face.
void Reader::add_patch(const Piece& piece, std::size_t patch, const ValueBlock& like, const PatchValues* given,
                       const Buffer<double>& inner) {
    const FaceBlock& faces = mesh_.face_blocks[piece.blocks[patch]];
    const auto n = static_cast<std::size_t>(like.components);
    const std::string& type = given != nullptr ? given->type : piece.patches[patch].type;
    if (faces.kind == inner_code || faces.count == 0 || type == "empty") {
        return;
    }
    ValueBlock block;
    block.variable = like.variable;
    block.canonical = like.canonical;
    block.unit = like.unit;
    block.zone = faces.zone;
    block.first = faces.first;
    block.count = faces.count;
    block.components = like.components;
    block.values.grow_to(faces.count * n);
    if (given != nullptr && !given->list.empty()) {
        if (given->list.size() != block.values.size()) {
            refuse(piece.folder / time_name_ / like.variable,
                   "patch '" + piece.patches[patch].name + "' has " + std::to_string(given->list.size() / n) +
                       " values for " + std::to_string(faces.count) + " faces");
        }
        std::copy(given->list.begin(), given->list.end(), block.values.begin());
    } else {
        for (std::size_t i = 0; i < faces.count; ++i) {
            const std::size_t cell = faces.c0[i] - 1 - piece.first_cell;
            for (std::size_t k = 0; k < n; ++k) {
                block.values[i * n + k] = given != nullptr && !given->uniform.empty()   ? given->uniform[k]
                                          : given != nullptr && type == "noSlip"        ? 0
                                          : inner.empty()                               ? std::nan("")
                                                                                        : inner[cell * n + k];
            }
        }
    }
    values_.push_back(std::move(block));
}

void Reader::read_field(const Piece& piece, const fs::path& file) {
    FoamInput in(file);
    const std::string& type = in.class_name();
    const std::size_t components = type.starts_with("vol") && type.ends_with("Field") ? FoamInput::components_of(type) : 0;
    ValueBlock block;
    block.variable = file.filename().string();
    if (block.variable.ends_with(".gz")) {
        block.variable.resize(block.variable.size() - 3);
    }
    if (components == 0) {
        return;
    }
    in.allow_repeated(std::max(mesh_.cells, mesh_.faces));
    block.on_cells = true;
    block.zone = volume_zone;
    block.components = static_cast<int>(components);
    block.first = piece.first_cell + 1;
    block.count = piece.cells;
    std::vector<double> dimensions;
    Buffer<double> inner;
    std::map<std::string, PatchValues> patches;
    bool closed = false;
    for (std::string key = in.token(); !key.empty(); key = in.token()) {
        if (key == "dimensions") {
            in.expect("[");
            while (!in.accept(']')) {
                dimensions.push_back(in.number());
                if (dimensions.size() > 7) {
                    in.fail("more than seven dimensions");
                }
            }
            in.expect(";");
            name_quantity(block, dimensions);
            const auto wanted = [&](const std::string& name) { return matches_any(options_.arrays, name); };
            if (!wanted(block.variable) && !wanted(block.canonical) &&
                !(block.canonical.starts_with("kinematic_") && wanted(block.canonical.substr(10)))) {
                return;
            }
        } else if (key == "internalField") {
            const std::string how = in.token();
            if (how == "nonuniform") {
                in.token();
                inner = in.reals(components);
            } else if (how == "uniform") {
                const auto one = in.value(components);
                inner.grow_to(piece.cells * components);
                for (std::size_t i = 0; i < inner.size(); ++i) {
                    inner[i] = one[i % components];
                }
            } else {
                in.fail("expected 'uniform' or 'nonuniform', found '" + how.substr(0, 40) + "'");
            }
            in.expect(";");
            if (inner.size() != piece.cells * components) {
                in.fail("the field has " + std::to_string(inner.size() / components) + " values for " +
                        std::to_string(piece.cells) + " cells: it belongs to another mesh");
            }
        } else if (key == "boundaryField") {
            in.expect("{");
            for (std::string name = in.token(); name != "}"; name = in.token()) {
                if (name.empty()) {
                    in.fail("the file ends within the boundary field");
                }
                patches[name] = read_patch_values(in, components);
            }
            closed = true;
        } else if (!key.starts_with("#")) {
            in.skip_entry();
        }
    }
    if (dimensions.empty() || inner.size() != piece.cells * components || !closed) {
        in.fail("the field is not whole: is the file cut short?");
    }
    // The function object's wall shear stress acts on the fluid; ours on the body.
    const double sign = block.canonical.ends_with("wall_shear") ? -1 : 1;
    for (std::size_t p = 0; p < piece.patches.size(); ++p) {
        const auto found = patches.find(piece.patches[p].name);
        const std::size_t before = values_.size();
        add_patch(piece, p, block, found != patches.end() ? &found->second : nullptr, inner);
        for (std::size_t v = before; v < values_.size() && sign < 0; ++v) {
            for (double& x : values_[v].values) {
                x = -x;
            }
        }
    }
    kinematic_ = kinematic_ || block.canonical == "kinematic_pressure";
    if (!options_.surfaces_only && sign > 0) {
        block.values = std::move(inner);
        values_.push_back(std::move(block));
    }
}

void Reader::read_fields(const Piece& piece) {
    if (time_name_.empty()) {
        return;
    }
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(piece.folder / time_name_, error)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file(error) && name.front() != '.' && !name.ends_with("~")) {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
        progress_.check();
        read_field(piece, file);
    }
}

void Reader::finish(Field& field) const {
    field.format = "OpenFOAM";
    field.files = {folder_.string()};
    field.pressure.kind = kinematic_ ? PressureReference::Kind::gauge : PressureReference::Kind::unknown;
    if (!time_name_.empty()) {
        field.metadata.emplace_back("time", time_name_);
    }
    if (times_.size() > 1) {
        field.metadata.emplace_back("times", std::to_string(times_.size()) + " from " + core::format_number(times_.front()) +
                                                 " to " + core::format_number(times_.back()));
    }
    if (pieces_.size() > 1) {
        field.metadata.emplace_back("processors", std::to_string(pieces_.size()));
    }
    for (auto& zone : field.zones) {
        const std::string& type = zone.original_kind;
        if (zone.surface != nullptr) {
            zone.kind = type == "wall" || type == "mappedWall" ? ZoneKind::wall
                        : type.starts_with("symmetry")         ? ZoneKind::symmetry
                        : type.starts_with("cyclic")           ? ZoneKind::periodic
                        : type == "patch"                      ? ZoneKind::unknown
                                                               : ZoneKind::other;
        }
    }
    field.problems.insert(field.problems.end(), problems_.begin(), problems_.end());
}

Field Reader::read() {
    find_pieces();
    choose_time();
    mesh_.dimension = 3;
    mesh_.length_unit = "m";
    mesh_.length_unit_known = true;
    mesh_.labels.push_back({volume_zone, "fluid", "internalMesh"});
    for (auto& piece : pieces_) {
        progress_.report(0.5 * static_cast<double>(&piece - pieces_.data()) / static_cast<double>(pieces_.size()),
                         "reading the mesh in " + piece.folder.filename().string());
        read_mesh(piece);
    }
    CellBlock cells;
    cells.zone = volume_zone;
    cells.count = mesh_.cells;
    mesh_.cell_blocks.push_back(std::move(cells));
    check_mesh(mesh_, options_.surfaces_only, progress_);
    for (const auto& piece : pieces_) {
        progress_.report(0.5, "reading the fields of time " + time_name_);
        read_fields(piece);
    }
    Field field = field_from(std::move(mesh_), std::move(values_), options_, progress_);
    finish(field);
    return field;
}

bool recognises(std::string_view head, const fs::path& path) {
    if (is_folder(path)) {
        return is_case(path);
    }
    const std::string name = path.filename().string();
    return (path.extension() == ".foam" || path.extension() == ".OpenFOAM" ||
            (name == "controlDict" && head.find("FoamFile") != std::string_view::npos)) &&
           !case_folder(path).empty();
}

Field read(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    Reader reader(path, options, progress);
    return telling([&] { return reader.read(); }, [&] { return reader.understood(); });
}

}  // namespace

Importer openfoam_importer() { return {"OpenFOAM", recognises, read}; }

}  // namespace underbody::postproc
