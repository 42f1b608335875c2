// The fields of one time of an OpenFOAM case, on its cells and patches.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "postproc/importers/mesh/face_mesh.h"
#include "postproc/importers/openfoam/openfoam_input.h"
#include "postproc/importers/openfoam/openfoam_keys.h"

namespace underbody::postproc {

constexpr int foam_volume_zone = 1;
constexpr int foam_inner_code = 2;  ///< faces inside the mesh, as Fluent numbers them
constexpr int foam_patch_code = 4;

struct FoamPatch {
    std::string name;
    std::string type;
    std::vector<std::string> groups;  ///< that it is in, its kind among them
    std::string neighbour_processor;  ///< of faces between processors: the number of the other one
    std::uint64_t start = 0;
    std::uint64_t count = 0;
};

/// One folder with polyMesh and times: the whole case, or the share of one processor.
struct FoamPiece {
    std::filesystem::path folder;
    std::vector<FoamPatch> patches;
    std::uint64_t first_face = 0;  ///< ids from 0 in the whole mesh
    std::uint64_t first_cell = 0;
    std::uint64_t cells = 0;
    std::vector<std::size_t> blocks;  ///< of the mesh, one a patch
};

/// Whether a file of a time's folder is meant as a field, by its name.
inline bool foam_field_name(const std::string& name) { return name.front() != '.' && !name.ends_with("~"); }

/// Gives every cell and every patch the values of the fields that are asked for.
class FoamFields {
public:
    /// The mesh must outlive this; values go into `out`.
    FoamFields(const FaceMesh& mesh, std::filesystem::path case_folder, const ReadOptions& options,
               core::Progress& progress, std::vector<ValueBlock>& out)
        : mesh_(mesh), case_folder_(std::move(case_folder)), options_(options), progress_(progress), values_(out) {}

    /// All fields in the folder of a time. Macros and included files of the case are expanded; a field whose values
    /// only OpenFOAM can compute ("#calc", "#codeStream") is left out, and told. Throws InputError for one that is
    /// damaged or of another mesh.
    void read(const FoamPiece& piece, const std::filesystem::path& time);
    /// Is the pressure one over density?
    [[nodiscard]] bool kinematic() const { return kinematic_; }
    /// What was not read of the fields.
    [[nodiscard]] const core::Problems& problems() const { return problems_; }

private:
    /// What a field file gives to one patch.
    struct PatchValues {
        std::string type;
        std::vector<double> uniform;
        Buffer<double> list;
        bool one_a_face = false;  ///< `list` is what the file states, even when it is empty
        bool elsewhere = false;   ///< some of it stands in another file or entry, which is not read
    };
    struct BoundaryValues {
        std::vector<FoamKey> keys;
        std::vector<PatchValues> values;  ///< one a key
        bool elsewhere = false;
    };

    void read_field(const FoamPiece& piece, const std::filesystem::path& file);
    void add_patches(const FoamPiece& piece, const ValueBlock& block, const BoundaryValues& boundary,
                     const Buffer<double>& inner, double sign, const std::filesystem::path& file);
    void add_patch(const FoamPiece& piece, std::size_t patch, const ValueBlock& like, const PatchValues* given,
                   const Buffer<double>& inner, const std::filesystem::path& file);
    [[nodiscard]] bool is_wanted(const ValueBlock& block) const;
    static Buffer<double> inner_values(FoamInput& in, std::size_t components, std::uint64_t cells);
    static void name_quantity(ValueBlock& block, const std::vector<double>& dimensions);
    static PatchValues patch_values(FoamInput& in, const std::string& patch, std::size_t components);
    static void stated_value(FoamInput& in, std::size_t components, PatchValues& values, std::string& text);
    static BoundaryValues boundary_values(FoamInput& in, std::size_t components);
    void tell_guess(const FoamPatch& patch, const PatchValues* given, const std::string& variable,
                    const std::filesystem::path& file);

    const FaceMesh& mesh_;
    std::filesystem::path case_folder_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::vector<ValueBlock>& values_;
    core::Problems problems_;
    bool kinematic_ = false;
};

}  // namespace underbody::postproc
