// OpenFOAM cases: the faces of polyMesh with the two cells beside them, the fields of one time, patches as surfaces.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/inputs.h"
#include "core/text.h"
#include "postproc/field/times.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/mesh/face_mesh.h"
#include "postproc/importers/mesh/steps.h"
#include "postproc/importers/openfoam/openfoam_fields.h"
#include "postproc/importers/openfoam/openfoam_input.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
    core::note_presence(path);
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
    core::note_names(folder, "[-+.0-9]*");  // what else lies there, a log, changes nothing
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

/// Whether the folder of a time holds a field: one that a solver was ended in, or that holds only its clock, does not.
bool has_fields(const fs::path& time) {
    core::note_names(time, "[!.]*");
    std::error_code error;
    const fs::directory_iterator entries(time, error);
    return std::any_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
        std::error_code ignored;
        return foam_field_name(entry.path().filename().string()) && entry.is_regular_file(ignored);
    });
}

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
    void read_mesh(FoamPiece& piece);
    [[nodiscard]] fs::path mesh_file(const FoamPiece& piece, const std::string& name) const;
    void read_points(const FoamPiece& piece, std::vector<std::uint32_t>& place);
    void check_neighbour(const FoamPatch& patch, const FoamInput& in) const;
    void read_patches(FoamPiece& piece, std::uint64_t inner, std::uint64_t faces);
    void cut_faces(FoamPiece& piece, const Buffer<std::uint32_t>& offsets, const Buffer<std::uint32_t>& nodes,
                   const Buffer<std::uint32_t>& owner, const Buffer<std::uint32_t>& neighbour,
                   const std::vector<std::uint32_t>& place);
    int zone_of(const FoamPatch& patch);
    void finish(Field& field) const;
    void find_density(Field& field) const;

    fs::path path_;
    fs::path folder_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::vector<FoamPiece> pieces_;
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
    text += listed_zones(mesh_);
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
    const auto share = [&](std::size_t number) { return folder_ / ("processor" + std::to_string(number)); };
    for (std::size_t p = 0; is_folder(share(p)); ++p) {
        pieces_.push_back({share(p), {}, 0, 0, 0, {}});
    }
    core::note_names(folder_, "processor*");
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_, error)) {
        const std::string name = entry.path().filename().string();
        const auto number =
            name.starts_with("processor") ? core::parse_number(std::string_view(name).substr(9)) : std::nullopt;
        if (number && *number > static_cast<double>(pieces_.size()) && is_folder(entry.path() / "constant")) {
            throw core::InputError(
                "missing",
                "there is '" + name + "', but no " + share(pieces_.size()).filename().string() +
                    ": a share of the case is lost",
                {folder_.string(), {}, {}, {}},
                "copy all its processor folders, or put the case together where it ran (reconstructPar)");
        }
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
    if (times.empty() && options_.time) {
        (void)step_at({}, *options_.time, folder_.string());
    }
    if (times.empty()) {
        problems_.push_back({core::Problem::Severity::note,
                             "the case has no times: only its mesh is read",
                             {folder_.string(), {}, {}, {}}});
        return;
    }
    if (options_.time) {
        time_name_ = times[step_at(times_, *options_.time, folder_.string())].second.filename().string();
        return;
    }
    const auto last =
        std::find_if(times.rbegin(), times.rend(), [](const auto& one) { return has_fields(one.second); });
    const auto& chosen = last == times.rend() ? times.back() : *last;
    time_name_ = chosen.second.filename().string();
    const bool newest = last == times.rend() || last == times.rbegin();
    const std::string newest_name = times.back().second.filename().string();
    if (!newest) {
        problems_.push_back({core::Problem::Severity::warning,
                             "time " + newest_name + " holds no field: the last time that does is read (" + time_name_ +
                                 " of " + std::to_string(times.size()) + " times)",
                             {folder_.string(), {}, {}, {}}});
    } else if (times.size() > 1) {
        problems_.push_back({core::Problem::Severity::note,
                             "the last of " + std::to_string(times.size()) + " times is read (" + time_name_ + ")",
                             {folder_.string(), {}, {}, {}}});
    }
}

/// Of the chosen time or the last one before it that has it (moving meshes), else of constant.
fs::path Reader::mesh_file(const FoamPiece& piece, const std::string& name) const {
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
void Reader::read_points(const FoamPiece& piece, std::vector<std::uint32_t>& place) {
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
            list.fail("addresses for " + std::to_string(numbers.size()) + " points, there are " +
                      std::to_string(count));
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

/// The share of the processor beyond these faces must be there too.
void Reader::check_neighbour(const FoamPatch& patch, const FoamInput& in) const {
    if (pieces_.front().folder != folder_ && patch.count > 0 && !patch.neighbour_processor.empty() &&
        !is_folder(folder_ / ("processor" + patch.neighbour_processor))) {
        throw core::InputError("missing",
                               "'" + patch.name + "' leads to processor" + patch.neighbour_processor +
                                   ", which is not there: a share of the case is lost",
                               in.place(),
                               "copy the folder processor" + patch.neighbour_processor +
                                   ", or put the case together where it ran (reconstructPar)");
    }
}

void Reader::read_patches(FoamPiece& piece, std::uint64_t inner, std::uint64_t faces) {
    FoamInput in(mesh_file(piece, "boundary"));
    if (!in.accept('(')) {
        in.count();
        in.expect("(");
    }
    while (!in.accept(')')) {
        FoamPatch patch;
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
            } else if (key == "neighbProcNo") {
                patch.neighbour_processor = in.token();
                in.expect(";");
            } else if (key == "inGroups") {  // "2(hull wall);", "(hull wall);"
                for (std::string word = in.token(); word != ";"; word = in.token()) {
                    if (word.empty()) {
                        in.fail("the file ends within the groups of patch '" + patch.name + "'");
                    }
                    patch.groups.push_back(word);
                }
            } else {
                in.skip_entry();
            }
        }
        patch.groups.emplace_back(patch.type == "mappedWall" ? "wall" : patch.type);
        check_neighbour(patch, in);
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

int Reader::zone_of(const FoamPatch& patch) {
    const auto [found, fresh] = zones_.try_emplace(patch.name, foam_volume_zone + 1 + static_cast<int>(zones_.size()));
    if (fresh) {
        mesh_.labels.push_back({found->second, patch.type, patch.name});
    }
    return found->second;
}

/// OpenFOAM's normals point from owner to neighbour; turned round they point into the owner, as a FaceMesh wants.
void Reader::cut_faces(FoamPiece& piece, const Buffer<std::uint32_t>& offsets, const Buffer<std::uint32_t>& nodes,
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
        add(0, foam_inner_code, 0, neighbour.size());
    }
    for (const auto& patch : piece.patches) {
        // Faces between processors are inside the mesh.
        const bool inside = patch.type.starts_with("processor");
        piece.blocks.push_back(mesh_.face_blocks.size());
        add(inside ? 0 : zone_of(patch), inside ? foam_inner_code : foam_patch_code, patch.start, patch.count);
    }
}

void Reader::read_mesh(FoamPiece& piece) {
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
        owner_file.fail("there are " + std::to_string(faces) + " faces, " + std::to_string(owner.size()) +
                        " owners and " + std::to_string(neighbour.size()) + " neighbours");
    }
    piece.first_face = mesh_.faces;
    piece.first_cell = mesh_.cells;
    for (const auto* list : {&owner, &neighbour}) {
        for (const std::uint32_t cell : *list) {
            piece.cells = std::max<std::uint64_t>(piece.cells, std::uint64_t{cell} + 1);
        }
    }
    if (piece.cells > faces) {  // a cell has four faces at least, each with two cells at most
        owner_file.fail("a face names cell " + std::to_string(piece.cells - 1) + ", more than the " +
                        std::to_string(faces) + " faces can enclose");
    }
    read_patches(piece, neighbour.size(), faces);
    cut_faces(piece, offsets, nodes, owner, neighbour, place);
    mesh_.faces += faces;
    mesh_.cells += piece.cells;
}

/// The density that the case's function objects take for their forces: incompressible cases state it nowhere else.
void Reader::find_density(Field& field) const {
    const fs::path control = folder_ / "system" / "controlDict";
    if (!kinematic_ || !FoamInput::exists(control)) {
        return;
    }
    std::set<double> stated;
    try {
        FoamInput in(control);
        for (std::string word = in.token(); !word.empty(); word = in.token()) {
            if (word != "rhoInf") {
                continue;
            }
            if (const auto value = core::parse_number(in.token())) {  // "rho rhoInf;" is not the value
                stated.insert(*value);
            }
        }
    } catch (const core::InputError&) {
        return;  // a dictionary that only the solver understands says nothing to us
    }
    if (stated.size() == 1 && *stated.begin() > 0) {
        field.density = *stated.begin();
        field.metadata.emplace_back("density [kg/m^3]",
                                    core::format_number(*field.density) + " (rhoInf of the case's function objects)");
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
        state_times(field, times_);
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
    mesh_.labels.push_back({foam_volume_zone, "fluid", "internalMesh"});
    for (auto& piece : pieces_) {
        progress_.report(0.5 * static_cast<double>(&piece - pieces_.data()) / static_cast<double>(pieces_.size()),
                         "reading the mesh in " + piece.folder.filename().string());
        read_mesh(piece);
    }
    CellBlock cells;
    cells.zone = foam_volume_zone;
    cells.count = mesh_.cells;
    mesh_.cell_blocks.push_back(std::move(cells));
    check_mesh(mesh_, options_.surfaces_only, progress_);
    progress_.report(0.5, "reading the fields of time " + time_name_);
    FoamFields fields(mesh_, folder_, options_, progress_, values_);
    for (const auto& piece : pieces_) {
        if (!time_name_.empty()) {
            fields.read(piece, piece.folder / time_name_);
        }
    }
    kinematic_ = fields.kinematic();
    problems_.insert(problems_.end(), fields.problems().begin(), fields.problems().end());
    Field field = field_from(std::move(mesh_), std::move(values_), options_, progress_);
    finish(field);
    find_density(field);
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
