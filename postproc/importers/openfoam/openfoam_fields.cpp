#include "postproc/importers/openfoam/openfoam_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>

#include "core/counted.h"
#include "core/inputs.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
    throw core::InputError("format", what, {file.string(), {}, {}, {}}, "the case is damaged or incomplete");
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

/// Patches whose kind is their boundary condition.
bool is_constraint(const std::string& type) {
    return type.starts_with("symmetry") || type.starts_with("cyclic") || type.starts_with("processor") ||
           type == "empty" || type == "wedge" || type == "overset";
}

}  // namespace

/// What the numbers are, out of the dimensions that the file states.
void FoamFields::name_quantity(ValueBlock& block, const std::vector<double>& dimensions) {
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

namespace {

constexpr const char* values_of_cells =
    "valuesOfTheCells";  ///< what "$internalField" stands for where each cell has its own
constexpr const char* not_here = "valuesOfAnotherPatch";

/// "uniform 5", "uniform (1 0 0)", to be read again.
std::string as_text(const std::string& before, const std::vector<double>& numbers) {
    std::string text = before + (numbers.size() > 1 ? " (" : " ");
    for (const double number : numbers) {
        text += core::format_number(number, 17) + " ";
    }
    return text + (numbers.size() > 1 ? ")" : "");
}

/// OpenFOAM's symmetric tensors stand as xx xy xz yy yz zz; here, as in VTK, as xx yy zz xy yz xz.
template <typename Values>
void order_as_vtk(Values& values, std::size_t components) {
    for (std::size_t i = 0; components == 6 && i + 6 <= values.size(); i += 6) {
        const std::array<double, 6> own = {values[i],     values[i + 3], values[i + 5],
                                           values[i + 1], values[i + 4], values[i + 2]};
        std::copy(own.begin(), own.end(), &values[i]);
    }
}

}  // namespace

/// What stands behind "value". A value that cannot be known here is one that stands elsewhere.
void FoamFields::stated_value(FoamInput& in, std::size_t components, PatchValues& values, std::string& text) {
    const std::string how = in.token();
    values.uniform.clear();
    values.one_a_face = values.elsewhere = false;
    if (how == "uniform") {
        try {
            values.uniform = in.value(components);
        } catch (const core::InputError& error) {
            if (error.kind() != FoamInput::kind_unread) {
                throw;
            }
            values.elsewhere = true;
            in.skip_to_end_of_value();
            return;
        }
        text = as_text("uniform", values.uniform);
        order_as_vtk(values.uniform, components);
        in.expect(";");
    } else if (how == "nonuniform") {
        in.skip_list_type();
        values.list = in.reals(components);
        order_as_vtk(values.list, components);
        values.one_a_face = true;
        text = not_here;
        in.expect(";");
    } else if (how != ";") {
        values.elsewhere = how != values_of_cells;
        text = how;
        in.skip_entry();
    }
}

FoamFields::PatchValues FoamFields::patch_values(FoamInput& in, const std::string& patch, std::size_t components) {
    PatchValues values;
    std::string all;
    if (const std::string brace = in.token(); brace.empty()) {
        in.fail("the file ends within the boundary field");
    } else if (brace != "{") {
        in.give_up("the entry of patch '" + patch + "' is no dictionary in braces");
    }
    in.enter(patch);
    for (std::string key = in.token(); key != "}"; key = in.token()) {
        if (key.empty()) {
            in.fail("the file ends within a patch");
        }
        std::string text;
        if (key == ";") {
            continue;  // behind a macro
        }
        if (key == "type") {
            text = values.type = in.token();
            in.expect(";");
        } else if (key == "value") {
            stated_value(in, components, values, text);
        } else if (key.starts_with("#")) {
            in.skip_directive(key);
            values.elsewhere = true;
            continue;
        } else {
            values.elsewhere = values.elsewhere || key.starts_with("$");
            in.skip_entry(&text);
        }
        in.define(key, text);
        all += key + " " + text + ";\n";
    }
    in.leave();
    in.define(patch, all);
    return values;
}

/// The entry "boundaryField" behind its key.
FoamFields::BoundaryValues FoamFields::boundary_values(FoamInput& in, std::size_t components) {
    BoundaryValues boundary;
    in.expect("{");
    in.enter("boundaryField");
    for (std::string name = in.token(); name != "}" || in.was_quoted(); name = in.token()) {
        if (name.empty()) {
            in.fail("the file ends within the boundary field");
        }
        if (!in.was_quoted() && name == ";") {
            continue;  // behind a macro
        }
        if (!in.was_quoted() && (name.starts_with("#") || name.starts_with("$"))) {
            if (name.front() == '#') {
                in.skip_directive(name);  // boundary conditions of "setConstraintTypes" state no values
            }
            boundary.elsewhere = true;
            continue;
        }
        try {
            boundary.keys.emplace_back(name, in.was_quoted());
        } catch (const core::InputError& error) {
            in.fail(error.message());
        }
        boundary.values.push_back(patch_values(in, name, components));
    }
    in.leave();
    return boundary;
}

/// A boundary condition whose values may not be those of the cells, though these are taken.
void FoamFields::tell_guess(const FoamPatch& patch, const PatchValues* given, const std::string& variable,
                            const fs::path& file) {
    const std::string& type = given != nullptr ? given->type : patch.type;
    if (is_constraint(patch.type) ||
        (given != nullptr && (given->one_a_face || !given->uniform.empty() || type == "noSlip" || !given->elsewhere))) {
        return;
    }
    problems_.push_back(
        {core::Problem::Severity::warning,
         "patch '" + patch.name + "' " +
             (given == nullptr ? "has no entry in '" + variable + "'"
                               : "takes its entry in '" + variable + "' from another, which is not read") +
             ": its values are those of the cells beside it",
         {file.string(), {}, {}, {}}});
}

/// Boundary conditions that state no value take it from the cell beside the face.
void FoamFields::add_patch(const FoamPiece& piece, std::size_t patch, const ValueBlock& like, const PatchValues* given,
                           const Buffer<double>& inner, const fs::path& file) {
    const FaceBlock& faces = mesh_.face_blocks[piece.blocks[patch]];
    const auto n = static_cast<std::size_t>(like.components);
    const std::string& type = given != nullptr ? given->type : piece.patches[patch].type;
    if (faces.kind == foam_inner_code || faces.count == 0 || type == "empty") {
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
    if (given != nullptr && given->one_a_face) {
        if (given->list.size() != block.values.size()) {
            refuse(file, "patch '" + piece.patches[patch].name + "' has " +
                             core::counted(given->list.size() / n, "value") + " for " +
                             core::counted(faces.count, "face"));
        }
        std::copy(given->list.begin(), given->list.end(), block.values.begin());
    } else {
        for (std::size_t i = 0; i < faces.count; ++i) {
            const std::size_t cell = faces.c0[i] - 1 - piece.first_cell;
            for (std::size_t k = 0; k < n; ++k) {
                block.values[i * n + k] = given != nullptr && !given->uniform.empty() ? given->uniform[k]
                                          : given != nullptr && type == "noSlip"      ? 0
                                          : inner.empty()                             ? std::nan("")
                                                                                      : inner[cell * n + k];
            }
        }
    }
    values_.push_back(std::move(block));
}

bool FoamFields::is_wanted(const ValueBlock& block) const {
    const auto wanted = [&](const std::string& name) { return matches_any(options_.arrays, name); };
    return wanted(block.variable) || wanted(block.canonical) ||
           (block.canonical.starts_with("kinematic_") && wanted(block.canonical.substr(10)));
}

/// The rest of the entry "internalField".
Buffer<double> FoamFields::inner_values(FoamInput& in, std::size_t components, std::uint64_t cells) {
    Buffer<double> values;
    const std::string how = in.token();
    if (how == "nonuniform") {
        in.skip_list_type();
        values = in.reals(components);
        order_as_vtk(values, components);
        in.define("internalField", values_of_cells);
    } else if (how == "uniform") {
        auto one = in.value(components);
        in.define("internalField", as_text("uniform", one));
        order_as_vtk(one, components);
        values.grow_to(cells * components);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = one[i % components];
        }
    } else if (how.starts_with("$") || how.starts_with("#")) {
        in.give_up_at_macro(how);
    } else {
        in.fail("expected 'uniform' or 'nonuniform', found '" + how.substr(0, 40) + "'");
    }
    in.expect(";");
    if (values.size() != cells * components) {
        in.fail("the field has " + std::to_string(values.size() / components) + " values for " + std::to_string(cells) +
                " cells: it belongs to another mesh");
    }
    return values;
}

/// The values of a field on the patches of a piece of the mesh.
void FoamFields::add_patches(const FoamPiece& piece, const ValueBlock& block, const BoundaryValues& boundary,
                             const Buffer<double>& inner, double sign, const fs::path& file) {
    for (std::size_t p = 0; p < piece.patches.size(); ++p) {
        const FoamPatch& patch = piece.patches[p];
        const int key = key_for_patch(boundary.keys, patch.name, patch.groups);
        const PatchValues* given = key >= 0 ? &boundary.values[static_cast<std::size_t>(key)] : nullptr;
        const std::size_t before = values_.size();
        add_patch(piece, p, block, given, inner, file);
        if (values_.size() > before && (given != nullptr || !boundary.elsewhere)) {
            tell_guess(patch, given, block.variable, file);
        }
        for (std::size_t v = before; v < values_.size() && sign < 0; ++v) {
            for (double& x : values_[v].values) {
                x = -x;
            }
        }
    }
}

void FoamFields::read_field(const FoamPiece& piece, const fs::path& file) {
    FoamInput in(file);
    const std::string& type = in.class_name();
    const std::size_t components =
        type.starts_with("vol") && type.ends_with("Field") ? FoamInput::components_of(type) : 0;
    ValueBlock block;
    block.variable = file.filename().string();
    if (block.variable.ends_with(".gz")) {
        block.variable.resize(block.variable.size() - 3);
    }
    if (components == 0) {
        return;
    }
    in.allow_repeated(std::max(mesh_.cells, mesh_.faces));
    in.expand_macros(case_folder_);
    block.on_cells = true;
    block.zone = foam_volume_zone;
    block.components = static_cast<int>(components);
    block.first = piece.first_cell + 1;
    block.count = piece.cells;
    std::vector<double> dimensions;
    Buffer<double> inner;
    BoundaryValues boundary;
    bool closed = false;
    for (std::string key = in.token(); !key.empty(); key = in.token()) {
        if (key == "dimensions") {
            dimensions = in.dimensions();
            name_quantity(block, dimensions);
            if (!is_wanted(block)) {
                return;
            }
        } else if (key == "internalField") {
            inner = inner_values(in, components, piece.cells);
        } else if (key == "boundaryField") {
            boundary = boundary_values(in, components);
            closed = true;
        } else if (key.starts_with("#")) {
            in.skip_directive(key);
        } else if (key != ";") {
            in.take_entry(key);
        }
    }
    if (dimensions.empty() || inner.size() != piece.cells * components || !closed) {
        in.fail("the field is not whole: is the file cut short?");
    }
    // The function object's wall shear stress acts on the fluid; ours on the body.
    const double sign = block.canonical.ends_with("wall_shear") ? -1 : 1;
    add_patches(piece, block, boundary, inner, sign, file);
    kinematic_ = kinematic_ || block.canonical == "kinematic_pressure";
    if (!options_.surfaces_only && sign > 0) {
        block.values = std::move(inner);
        values_.push_back(std::move(block));
    }
}

namespace {

/// Notes or a table that somebody put among the fields: neither the header of OpenFOAM's files nor the comment before
/// it. Empty and packed files are taken for fields.
bool is_foreign(const fs::path& file) {
    std::string head(4096, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    const std::string_view text = core::trimmed(head);
    const bool packed = file.extension() == ".gz" || text.starts_with('\x1f');
    constexpr std::size_t word = 8;  // of "FoamFile": less is a file that was cut
    return text.size() > word && !packed && !text.starts_with('/') && text.find("FoamFile") == std::string_view::npos;
}

}  // namespace

void FoamFields::read(const FoamPiece& piece, const fs::path& time) {
    core::note_names(time, "[!.]*");
    std::vector<fs::path> files;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(time, ignored)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file(ignored) && foam_field_name(name)) {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
        progress_.check();
        if (is_foreign(file)) {
            core::note_content(file);
            problems_.push_back({core::Problem::Severity::warning,
                                 "'" + file.filename().string() + "' lies among the fields and is none: passed over",
                                 {file.string(), {}, {}, {}}});
            continue;
        }
        const std::size_t before = values_.size();
        try {
            read_field(piece, file);
        } catch (const core::InputError& error) {
            if (error.kind() != FoamInput::kind_unread) {
                throw;
            }
            values_.resize(before);
            problems_.push_back({core::Problem::Severity::warning,
                                 "the field '" + file.filename().string() + "' is left out: " + error.message(),
                                 error.place()});
        }
    }
}

}  // namespace underbody::postproc
