// underbody views FILE... --out FOLDER: pictures of a case, or of several with one range and camera.
#include "postproc/views/views.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/field/field.h"
#include "postproc/field/kinematic.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/probe/probe.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

namespace fs = std::filesystem;

struct ViewsArguments {
    std::vector<std::string> files;
    std::string out = "views";
    std::vector<std::string> names;
    std::vector<std::string> ranges;
    std::string symmetry, base = "*base*", forward = "+x", up = "+z", difference, density, camera;
    int width = 1200, height = 800;
    bool list = false;
    FieldOptions field;
};

/// Unit of a range's ends; empty: any (a key that nobody knows is refused with the views).
std::string range_unit(const std::string& key) {
    for (const auto& known : postproc::range_keys()) {
        if (known.name == key || (key == "speed" && known.name == "velocity") ||
            (key == "shear" && known.name == "wall_shear")) {
            return known.unit;
        }
    }
    return {};
}

postproc::ViewOptions view_options(const ViewsArguments& given) {
    postproc::ViewOptions options;
    options.forward = postproc::axis_from(given.forward);
    options.up = postproc::axis_from(given.up);
    options.symmetry = given.symmetry;
    options.zones = given.field.zones;
    options.base = given.base;
    options.camera = given.camera;
    if (!given.camera.empty()) {
        static_cast<void>(postproc::named_camera(given.camera, options.forward, options.up));
    }
    options.width = given.width;
    options.height = given.height;
    for (const auto& text : given.ranges) {  // pressure=-100:50, in SI or with units
        const auto equals = text.find('=');
        const auto colon = text.find(':', equals);
        if (equals == std::string::npos || colon == std::string::npos) {
            throw core::UsageError("usage", "--range '" + text + "' is no NAME=LOW:HIGH", {},
                                   "for instance --range pressure=-200:100");
        }
        const std::string key = text.substr(0, equals);
        const std::string unit = range_unit(key);
        const auto si = [&](const std::string& end) {
            const auto quantity = core::parse_quantity(end);
            return quantity.unit.empty() ? quantity.value
                                         : core::convert(quantity.value, quantity.unit,
                                                         unit.empty() ? core::si_unit(quantity.unit) : unit);
        };
        options.ranges.emplace_back(
            key, std::pair{si(text.substr(equals + 1, colon - equals - 1)), si(text.substr(colon + 1))});
    }
    return options;
}

/// Writes pictures and remembers what was written.
class Album {
public:
    Album(Shell& shell, const ViewsArguments& given) : shell_(shell), given_(given) {}

    void keep(const postproc::View& view, const std::string& prefix) {
        const fs::path path = fs::path(given_.out) / (prefix + view.name + ".png");
        core::write_file(path, view.png);
        shell_.print("wrote " + path.string() + ": " + view.caption);
        written_.push_back({{"file", path.string()},
                            {"name", view.name},
                            {"title", view.title},
                            {"caption", view.caption},
                            {"range", {view.range.first, view.range.second}}});
    }

    void keep(const core::Figure& figure, const std::string& name, const std::string& prefix) {
        const fs::path path = fs::path(given_.out) / (prefix + name + ".png");
        write_picture(figure, path);
        shell_.print("wrote " + path.string() + ": " + figure.caption);
        written_.push_back(
            {{"file", path.string()}, {"name", name}, {"title", figure.title}, {"caption", figure.caption}});
    }

    /// A view that could be drawn.
    void list(const std::string& name, const std::string& file, bool several) {
        shell_.print((several ? file + ": " : "") + name);
        written_.push_back({{"name", name}, {"of", file}});
    }

    [[nodiscard]] nlohmann::json json() const { return {{"views", written_}}; }

private:
    Shell& shell_;
    const ViewsArguments& given_;
    nlohmann::json written_ = nlohmann::json::array();
};

bool has_profile(const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), "streamlines-gap") != names.end();  // a volume, a velocity and a base
}

/// Names of the cases that no two share: that of the file, with as many of its folders before it as it takes
/// ("a/case").
std::vector<std::string> names_of(const std::vector<ConditionedFile>& files) {
    struct Parts {
        std::vector<std::string> folders;
        std::string stem, file;
    };
    std::vector<Parts> all;
    for (const auto& file : files) {
        fs::path path = fs::absolute(file.path).lexically_normal();
        path = path.has_filename() ? path : path.parent_path();
        Parts parts{{}, postproc::case_stem(path), path.filename().string()};
        for (const auto& folder : path.parent_path().relative_path()) {
            parts.folders.push_back(folder.string());
        }
        all.push_back(std::move(parts));
    }
    const auto count = [&](auto&& same) { return std::count_if(all.begin(), all.end(), same); };
    std::vector<std::string> names;
    for (const auto& parts : all) {
        const bool stem_is_shared =
            count([&](const Parts& other) { return other.folders == parts.folders && other.stem == parts.stem; }) > 1;
        std::string name = stem_is_shared ? parts.file : parts.stem;
        for (std::size_t depth = 1; depth <= parts.folders.size(); ++depth) {
            const auto tail = [depth](const Parts& of) {
                return std::vector<std::string>(
                    of.folders.end() - static_cast<std::ptrdiff_t>(std::min(depth - 1, of.folders.size())),
                    of.folders.end());
            };
            if (count([&](const Parts& other) {
                    return other.stem == parts.stem && other.folders != parts.folders && tail(other) == tail(parts);
                }) == 0) {
                break;
            }
            name.insert(0, parts.folders[parts.folders.size() - depth] + "/");
        }
        names.push_back(name);
    }
    return names;
}

/// What the names of their pictures begin with: "a-case-"; of one case nothing.
std::vector<std::string> prefixes_of(const std::vector<std::string>& names) {
    std::vector<std::string> prefixes;
    for (std::string name : names) {
        std::replace(name.begin(), name.end(), '/', '-');
        std::string prefix = name + "-";
        for (int again = 2; std::find(prefixes.begin(), prefixes.end(), prefix) != prefixes.end(); ++again) {
            prefix = name + "-" + std::to_string(again) + "-";
        }
        prefixes.push_back(names.size() > 1 ? prefix : "");
    }
    return prefixes;
}

void draw_case(Shell& shell, const ViewsArguments& given, const postproc::Field& field,
               const postproc::ViewOptions& shared, const std::string& case_name, const std::string& prefix,
               Album& album) {
    postproc::ViewOptions options = shared;
    options.case_name = case_name;
    auto possible = postproc::possible_views(field, options);
    if (has_profile(possible)) {
        possible.emplace_back("profile-gap");
    }
    if (possible.empty()) {
        throw core::InputError("view", "the field has no surface with a pressure to draw",
                               {field.files.front(), {}, {}, {}});
    }
    for (const auto& name : given.names) {
        if (std::find(possible.begin(), possible.end(), name) == possible.end()) {
            throw core::InputError("view", "there is no view '" + name + "' of this field",
                                   {field.files.front(), {}, {}, {}}, core::did_you_mean(name, possible));
        }
    }
    for (const auto& name : given.names.empty() ? possible : given.names) {
        shell.progress().check();
        if (given.list) {
            album.list(name, field.files.front(), !prefix.empty());
        } else if (name == "profile-gap") {
            postproc::GapOptions gap;
            gap.forward = options.forward;
            gap.up = options.up;
            gap.symmetry = options.symmetry;
            gap.zones = options.zones;
            gap.base = options.base;
            core::Figure figure = postproc::gap_profile_figure(field, gap, shell.progress());
            figure.title += ", " + options.case_name;
            album.keep(figure, name, prefix);
        } else {
            album.keep(postproc::view(field, name, options, shell.progress()), prefix);
        }
    }
}

/// Pictures show pascal: what a file has over density needs one.
void use_density(Shell& shell, const ViewsArguments& given, postproc::Field& field) {
    const auto density = given.density.empty()
                             ? std::nullopt
                             : std::optional<double>(option_value("--density", given.density, "kg/m^3"));
    if (!postproc::bring_to_pascal(field, density)) {
        shell.show_warning(field.files.front() + ": pressure is over density here: --density \"998 kg/m^3\" draws it");
    }
}

/// A file that two patterns fit is drawn once.
void name_once(Batch& batch) {
    std::vector<fs::path> seen;
    std::erase_if(batch.files, [&](const ConditionedFile& file) {
        const fs::path path = fs::absolute(file.path).lexically_normal();
        const bool again = std::find(seen.begin(), seen.end(), path) != seen.end();
        seen.push_back(path);
        return again;
    });
}

void check_difference(const ViewsArguments& given, std::size_t files) {
    if (files != 2) {
        throw core::UsageError("usage", "--difference compares two files", {},
                               "underbody views A B --difference pressure");
    }
    if (given.list || !given.names.empty()) {
        throw core::UsageError("usage", std::string("--difference draws one picture: ") +
                                            (given.list ? "--list" : "--view") + " means nothing with it");
    }
}

int run_views(Shell& shell, const ViewsArguments& given) {
    postproc::ViewOptions options = view_options(given);
    Batch batch = find_files(given.files, "", given.field.zones);
    shell.show(batch.problems);
    if (given.difference.empty()) {
        name_once(batch);
    } else {
        check_difference(given, batch.files.size());
    }
    std::vector<postproc::Field> fields;
    for (const auto& file : batch.files) {
        fields.push_back(shell.read_field(file.path, given.field.read_options()));
        shell.show(fields.back().problems);
        use_density(shell, given, fields.back());
    }
    const auto names = names_of(batch.files);
    Album album(shell, given);
    if (!given.difference.empty()) {
        options.case_name = names[1] + "  minus  " + names[0];
        album.keep(postproc::difference_view(fields[0], fields[1], given.difference, options, shell.progress()), "");
    } else {
        if (fields.size() > 1 && !given.list) {
            std::vector<const postproc::Field*> all;
            for (const auto& field : fields) {
                all.push_back(&field);
            }
            options = postproc::shared_view_options(all, options, shell.progress());
        }
        const auto prefixes = prefixes_of(names);
        for (std::size_t i = 0; i < fields.size(); ++i) {
            draw_case(shell, given, fields[i], options, names[i], prefixes[i], album);
        }
    }
    if (shell.json) {
        shell.print_json(album.json());
    }
    return done;
}

}  // namespace

void add_views_command(CLI::App& app, Shell& shell) {
    auto* command =
        app.add_subcommand("views", "pictures of a field: underbody, hull, symmetry plane, gap; needs no display");
    auto o = std::make_shared<ViewsArguments>();
    command->add_option("files", o->files, "CFD files, or patterns of names; several share colours and camera")
        ->required();
    command->add_option("-o,--out", o->out, "folder for the pictures")->capture_default_str();
    command->add_option("--view", o->names, "only these, by name; several with commas")
        ->delimiter(',')
        ->transform(trimmed_name);
    command->add_flag("--list", o->list, "only say which views each file allows");
    command->add_option("--difference", o->difference,
                        "draw the second file less the first one: pressure, wall_shear (of vectors the sizes)");
    command->add_option("--range", o->ranges,
                        "colour range, in SI or with units: pressure=-200:100, shear=\"0 Pa:5 Pa\", speed=0:1, "
                        "speed-symmetry=0:0.7, difference=-20:20");
    command->add_option(
        "--symmetry", o->symmetry,
        "half model: normal axis of its plane, with its place if that is not where the body is open: y, or y=0.1");
    command->add_option("--camera", o->camera,
                        "from where the body is seen: bottom, top, side (starboard), front, iso; default: as each view "
                        "is defined. Cuts and streamlines keep theirs");
    command->add_option("--base", o->base, "zone that is the base")->capture_default_str();
    command->add_option("--forward", o->forward, "axis of the file that looks forward")->capture_default_str();
    command->add_option("--up", o->up, "axis of the file that looks up")->capture_default_str();
    command->add_option("--density", o->density, "for files that hold pressure over density (OpenFOAM)");
    command->add_option("--width", o->width, "pixels")->check(CLI::Range(64, 8192))->capture_default_str();
    command->add_option("--height", o->height, "pixels")->check(CLI::Range(64, 8192))->capture_default_str();
    o->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody views body.csv --symmetry y --out pictures\n"
        "  underbody views case.cas.gz --zones base,hull --symmetry y --view speed-symmetry,streamlines-gap\n"
        "  underbody views case --density \"998 kg/m^3\" --symmetry y      an OpenFOAM case\n"
        "  underbody views h2.csv h5.csv --symmetry y                    one range and camera for both\n"
        "  underbody views body.csv --symmetry y --view pressure-hull --camera front\n"
        "  underbody views coarse.csv fine.csv --symmetry y --difference pressure");
    shell.on(command, [&shell, o] { return run_views(shell, *o); });
}

}  // namespace underbody::studio
