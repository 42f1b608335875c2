#include "postproc/importers/cgns/cgns_file.h"

#include <cgns_io.h>
#include <cgnslib.h>

#include <algorithm>
#include <fstream>

#include "core/file.h"
#include "core/inputs.h"
#include "core/text.h"
#include "postproc/importers/linked_files.h"

namespace underbody::postproc {

namespace {

/// What the library says of a link that leads nowhere is no damage.
std::string hint_for(const std::string& why, const char* otherwise) {
    return core::lower_case(why).find("linked") != std::string::npos
               ? "it takes a part from another file by a link: that one must lie where it did"
               : otherwise;
}

/// Top nodes of a CGNS file, read without a look at its version.
struct TopNodes {
    float version = 0;
    std::vector<std::string> bases;
};

TopNodes top_nodes(const std::string& path) {
    TopNodes top;
    int file = -1;
    double root = 0;
    if (cgio_open_file(path.c_str(), CGIO_MODE_READ, CGIO_FILE_NONE, &file) != CGIO_ERR_NONE) {
        return top;
    }
    int children = 0;
    if (cgio_get_root_id(file, &root) == CGIO_ERR_NONE &&
        cgio_number_children(file, root, &children) == CGIO_ERR_NONE) {
        for (int i = 1; i <= children; ++i) {
            std::array<char, CGIO_MAX_NAME_LENGTH + 1> name{};
            std::array<char, CGIO_MAX_LABEL_LENGTH + 1> label{};
            int read = 0;
            double node = 0;
            if (cgio_children_names(file, root, i, 1, CGIO_MAX_NAME_LENGTH + 1, &read, name.data()) != CGIO_ERR_NONE ||
                cgio_get_node_id(file, root, name.data(), &node) != CGIO_ERR_NONE ||
                cgio_get_label(file, node, label.data()) != CGIO_ERR_NONE) {
                continue;
            }
            std::array<char, CGIO_MAX_DATATYPE_LENGTH + 1> type{};
            std::array<cgsize_t, CGIO_MAX_DIMENSIONS> sizes{};
            int dimensions = 0;
            if (std::string_view(label.data()) == "CGNSBase_t") {
                top.bases.emplace_back(name.data());
            } else if (std::string_view(label.data()) == "CGNSLibraryVersion_t" &&
                       cgio_get_data_type(file, node, type.data()) == CGIO_ERR_NONE &&
                       cgio_get_dimensions(file, node, &dimensions, sizes.data()) == CGIO_ERR_NONE &&
                       std::string_view(type.data()) == "R4" && dimensions == 1 && sizes[0] == 1) {
                cgio_read_all_data(file, node, &top.version);
            }
        }
    }
    cgio_close_file(file);
    return top;
}

}  // namespace

/// The library here refuses files of a later version than its own by their number alone, and what it reads of them has
/// not changed since its own. It does follow links into them: a file of its own version, gone as soon as it is open,
/// links to their bases.
bool CgnsFile::open_newer(bool hdf5) {
    const TopNodes top = top_nodes(name_);
    if (!(top.version > static_cast<float>(CGNS_DOTVERS)) || top.bases.empty()) {
        return false;
    }
    const core::TemporaryFolder folder("underbody-cgns");
    const std::string own = (folder.path() / "links.cgns").string();
    const std::string target = std::filesystem::absolute(name_).string();
    int file = -1;
    int nodes = -1;
    double root = 0;
    double link = 0;
    cg_set_file_type(hdf5 ? CG_FILE_HDF5 : CG_FILE_ADF);
    if (cg_open(own.c_str(), CG_MODE_WRITE, &file) != CG_OK) {
        return false;
    }
    bool linked = cg_get_cgio(file, &nodes) == CG_OK && cg_root_id(file, &root) == CG_OK;
    for (const auto& base : top.bases) {
        linked = linked && cgio_create_link(nodes, root, base.c_str(), target.c_str(), ("/" + base).c_str(), &link) ==
                               CGIO_ERR_NONE;
    }
    linked = cg_close(file) == CG_OK && linked;
    version_ = top.version;
    return linked && cg_open(own.c_str(), CG_MODE_READ, &file_) == CG_OK;
}

CgnsFile::CgnsFile(const std::filesystem::path& path, std::optional<double> time, const std::string& base)
    : name_(path.string()) {
    core::note_content(path);
    std::error_code error;
    bytes_ = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    std::array<char, 4> head{};
    file.read(head.data(), head.size());
    const bool hdf5 = head[0] == '\x89';
    most_values_ = hdf5 ? bytes_ * 1032 : bytes_;  // HDF5 may be deflated
    if (cg_open(name_.c_str(), CG_MODE_READ, &file_) != CG_OK && !open_newer(hdf5)) {
        const std::string why = cg_get_error();
        throw core::InputError("format", "CGNS cannot open it: " + why, {name_, {}, {}, {}},
                               hint_for(why, "the file is cut short or damaged; copy it again"));
    }
    note_cgns_links(file_, path);
    try {
        std::array<char, 33> base_name{};
        const auto opened = [&](int result, const char* what) {
            if (result != CG_OK) {
                fail(std::string(what) + ": " + cg_get_error());
            }
        };
        opened(cg_nbases(file_, &bases_), "bases");
        if (bases_ < 1) {
            fail("there is no base in the file");
        }
        choose_step(time, base);
        opened(cg_base_read(file_, base_, base_name.data(), &cell_dimension_, &physical_dimension_), "base");
        if (cell_dimension_ < 1 || cell_dimension_ > 3) {
            fail("its cells have " + std::to_string(cell_dimension_) + " dimensions");
        }
        base_name_ = base_name.data();
        find_zones_of_step();
        read_units_of_base();
    } catch (const core::InputError&) {
        cg_close(file_);
        throw;
    }
}

std::vector<std::string> CgnsFile::base_names() const {
    std::vector<std::string> names;
    for (int base = 1; base <= bases_; ++base) {
        std::array<char, 33> name{};
        int cells = 0;
        int space = 0;
        names.emplace_back(cg_base_read(file_, base, name.data(), &cells, &space) == CG_OK ? name.data() : "");
    }
    return names;
}

/// By its name, or by its number where none has that name.
int CgnsFile::base_called(const std::string& base) const {
    const std::vector<std::string> names = base_names();
    if (const auto found = std::find(names.begin(), names.end(), base); found != names.end()) {
        return static_cast<int>(found - names.begin()) + 1;
    }
    const auto number = core::parse_integer(base);
    if (!number || *number < 1 || *number > bases_) {
        throw core::InputError("missing", "there is no base '" + base + "' in this file", {name_, {}, {}, {}},
                               core::did_you_mean(base, names));
    }
    return static_cast<int>(*number);
}

std::vector<std::string> CgnsFile::other_bases() const {
    std::vector<std::string> names = bases_ > 1 && !base_per_step_ ? base_names() : std::vector<std::string>();
    std::erase(names, base_name_);
    return names;
}

CgnsFile::~CgnsFile() { cg_close(file_); }

void CgnsFile::fail(const std::string& what) const {
    throw core::InputError("format", what, {name_, {}, {}, {}}, hint_for(what, "the file is damaged or incomplete"));
}

void CgnsFile::warn(const std::string& what) {
    if (std::find(warnings_.begin(), warnings_.end(), what) == warnings_.end()) {
        warnings_.push_back(what);
    }
}

void CgnsFile::ok(const CgnsZone& zone, int result, const char* what) const {
    if (result != CG_OK) {
        fail(zone, std::string(what) + ": " + cg_get_error());
    }
}

/// So many numbers of at least 4 bytes must be in the file.
void CgnsFile::check_room(const CgnsZone& zone, double count) const {
    if (!(count >= 0) || count * 4 > static_cast<double>(most_values_)) {
        fail(zone, "it claims " + core::format_number(count) + " numbers but the file has " + std::to_string(bytes_) +
                       " bytes");
    }
}
bool CgnsFile::go_to(const Path& path) const {
    std::vector<char*> labels;
    std::vector<int> numbers;
    for (const auto& [label, number] : path) {
        labels.push_back(const_cast<char*>(label));  // the library reads them only
        numbers.push_back(number);
    }
    return cg_golist(file_, base_, static_cast<int>(path.size()), labels.data(), numbers.data()) == CG_OK;
}

CgnsZone CgnsFile::zone(int index) const {
    CgnsZone zone;
    zone.index = index;
    std::array<char, 33> name{};
    std::array<cgsize_t, 9> size{};
    if (cg_zone_read(file_, base_, index, name.data(), size.data()) != CG_OK) {
        fail("zone " + std::to_string(index) + ": " + cg_get_error());
    }
    zone.name = name.data();
    CGNS_ENUMT(ZoneType_t) type{};
    ok(zone, cg_zone_type(file_, base_, index, &type), "zone type");
    zone.structured = type == CGNS_ENUMV(Structured);
    const int indices = zone.structured ? cell_dimension_ : 1;
    for (int k = 0; k < std::min(indices, 3); ++k) {
        zone.nodes[static_cast<std::size_t>(k)] = size[static_cast<std::size_t>(k)];
        zone.cells[static_cast<std::size_t>(k)] = std::max<cgsize_t>(0, size[static_cast<std::size_t>(indices + k)]);
    }
    check_room(zone, zone.all_cells() / 8);
    return zone;
}

}  // namespace underbody::postproc
