// Tecplot ASCII through VTK's reader, as far as that understands it.
#include <vtkTecplotReader.h>

#include <algorithm>
#include <cctype>

#include "core/file.h"
#include "core/text.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/vtk/vtk_output.h"
#include "postproc/importers/vtk/vtk_zones.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

bool is_tecplot(std::string_view head, const fs::path& /*path*/) {
    std::string text(core::trimmed(head.substr(0, 2000)));
    while (!text.empty() && text.front() == '#') {
        text.erase(0, std::min(text.find('\n'), text.size() - 1) + 1);
    }
    text = core::lower_case(text);
    return (text.starts_with("title") || text.starts_with("variables")) &&
           text.find("variables") != std::string::npos && text.find('=') != std::string::npos;
}
/// Coordinates that VTK's reader does not know by their names would all be 0; what else it does not know it takes for
/// numbers of the wrong meaning.
void check_tecplot(const fs::path& path) {
    const core::MappedFile file(path);
    const std::string_view text = file.bytes();
    const auto refuse_at = [&](std::size_t at, const std::string& what) {
        throw core::InputError(
            "format", what,
            {file.name(), 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'), {}, {}},
            "write the file without them, or as CGNS or VTK");
    };
    for (std::size_t at = text.find('*'); at != std::string_view::npos; at = text.find('*', at + 1)) {
        if (at > 0 && at + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[at - 1])) != 0 &&
            std::string_view("0123456789.+-").find(text[at + 1]) != std::string_view::npos) {
            refuse_at(at, "repeat counts (98*7.5) in Tecplot files are not read");
        }
    }
    const auto upper = [](char c) { return std::toupper(static_cast<unsigned char>(c)); };
    for (const std::string_view word : {"VARSHARELIST", "CONNECTIVITYSHAREZONE"}) {
        const std::boyer_moore_horspool_searcher searcher(word.begin(), word.end(), upper,
                                                          [&](char x, char y) { return upper(x) == upper(y); });
        if (const auto* const found = std::search(text.begin(), text.end(), searcher); found != text.end()) {
            refuse_at(static_cast<std::size_t>(found - text.begin()),
                      "what zones of a Tecplot file share (" + std::string(word) + ") is not read");
        }
    }
}

/// A variable that is a coordinate by its name ("X [ m ]") and that the reader took for something else.
void check_coordinates(const fs::path& path, const std::vector<std::string>& variables) {
    for (const auto& variable : variables) {
        const std::string name =
            core::lower_case(core::trimmed(std::string_view(variable).substr(0, variable.find_first_of("[("))));
        if (name == "x" || name == "y" || name == "z" || name.starts_with("coordinate")) {
            throw core::InputError(
                "format", "the variable '" + variable + "' is a coordinate by its name, which the reader wants bare",
                {path.string(), {}, {}, {}}, "call the coordinates \"X\", \"Y\", \"Z\" in the line of VARIABLES");
        }
    }
}

Field read_tecplot(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    check_tecplot(path);
    std::vector<std::string> variables;
    const auto prepare = [&](vtkTecplotReader& reader) {
        reader.SetFileName(path.c_str());
        reader.UpdateInformation();
        variables.clear();
        for (int i = 0; i < reader.GetNumberOfDataArrays(); ++i) {
            reader.SetDataArrayStatus(reader.GetDataArrayName(i), 1);
            variables.emplace_back(reader.GetDataArrayName(i));
        }
    };
    const auto object = output_of<vtkTecplotReader>(path, progress, prepare);
    check_coordinates(path, variables);
    return field_from_vtk(path, "Tecplot ASCII", object, options, progress);
}

}  // namespace

Importer tecplot_importer() { return {"Tecplot ASCII", is_tecplot, read_tecplot}; }

}  // namespace underbody::postproc
