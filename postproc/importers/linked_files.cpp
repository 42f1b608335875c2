#include "postproc/importers/linked_files.h"

#include <cgns_io.h>
#include <cgnslib.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "core/inputs.h"

namespace underbody::postproc {

namespace fs = std::filesystem;

namespace {

/// Values of attributes that name files, in the text of an XML file of VTK.
std::set<std::string> named_pieces(const std::string& text) {
    std::set<std::string> names;
    for (const std::string attribute : {" file=", " Source="}) {
        for (std::size_t at = text.find(attribute); at != std::string::npos; at = text.find(attribute, at + 1)) {
            const std::size_t open = at + attribute.size();
            const std::size_t close = open < text.size() ? text.find(text[open], open + 1) : std::string::npos;
            if (close != std::string::npos && (text[open] == '"' || text[open] == '\'')) {
                names.insert(text.substr(open + 1, close - open - 1));
            }
        }
    }
    return names;
}

/// Only files that are made of others are looked through: they are short.
std::string text_of_collection(const fs::path& path) {
    constexpr std::size_t head = 1024;
    constexpr std::size_t most = std::size_t{16} << 20;
    std::ifstream in(path, std::ios::binary);
    std::string text(head, '\0');
    in.read(text.data(), head);
    text.resize(static_cast<std::size_t>(in.gcount()));
    const std::size_t type = text.find("type=");
    const std::string kind = type == std::string::npos ? std::string() : text.substr(type + 6, 24);
    const bool collection = kind.starts_with("P") ? !kind.starts_with("PolyData")
                                                  : kind.find("MultiBlock") < 8 || kind.starts_with("Collection") ||
                                                        kind.find("Hierarchical") < 8 || kind.find("AMR") < 16;
    if (!collection) {
        return {};
    }
    std::string rest(most, '\0');
    in.read(rest.data(), most);
    rest.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
    return text + rest;
}

void note_pieces(const fs::path& path, std::set<std::string>& seen) {
    for (const auto& name : named_pieces(text_of_collection(path))) {
        note_linked(path, name);
        const fs::path piece = path.parent_path() / name;
        if (seen.insert(piece.string()).second) {
            note_pieces(piece, seen);
        }
    }
}

/// Nodes of a CGNS tree, as deep as a real one is and no further: a damaged one may go round.
class CgnsWalk {
public:
    CgnsWalk(int nodes, fs::path path) : nodes_(nodes), path_(std::move(path)) {}

    void visit(double node, int depth) {
        int children = 0;
        if (depth > deepest || cgio_number_children(nodes_, node, &children) != CGIO_ERR_NONE) {
            return;
        }
        for (int i = 1; i <= children && left_ > 0; ++i, --left_) {
            double child = 0;
            int read = 0;
            if (cgio_children_ids(nodes_, node, i, 1, &read, &child) != CGIO_ERR_NONE || read != 1) {
                return;
            }
            int length = 0;
            if (cgio_is_link(nodes_, child, &length) == CGIO_ERR_NONE && length > 0) {
                take_link(child);
            } else {
                visit(child, depth + 1);
            }
            cgio_release_id(nodes_, child);
        }
    }

private:
    void take_link(double node) {
        int file = 0;
        int name = 0;
        if (cgio_link_size(nodes_, node, &file, &name) != CGIO_ERR_NONE || file <= 0) {
            return;
        }
        std::string of_file(static_cast<std::size_t>(file) + 1, '\0');
        std::string of_node(static_cast<std::size_t>(name) + 1, '\0');
        if (cgio_get_link(nodes_, node, of_file.data(), of_node.data()) == CGIO_ERR_NONE) {
            note_linked(path_, of_file.c_str());
        }
    }

    static constexpr int deepest = 16;
    int nodes_;
    fs::path path_;
    int left_ = 200000;
};

}  // namespace

void note_linked(const fs::path& from, const std::string& name) {
    if (name.empty()) {
        return;
    }
    const fs::path beside = from.parent_path() / name;
    core::note_content(beside);
    if (fs::path(name).is_relative() && beside != fs::path(name)) {
        core::note_content(name);  // libraries look from where the program was started, too
    }
}

void note_vtk_pieces(const fs::path& path) {
    if (core::InputScope::current() != nullptr) {
        std::set<std::string> seen;
        note_pieces(path, seen);
    }
}

void note_cgns_links(int file, const fs::path& path) {
    int nodes = -1;
    double root = 0;
    if (core::InputScope::current() != nullptr && cg_get_cgio(file, &nodes) == CG_OK &&
        cg_root_id(file, &root) == CG_OK) {
        CgnsWalk(nodes, path).visit(root, 0);
    }
}

}  // namespace underbody::postproc
