// underbody body compare, underbody body sweep.
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/file.h"
#include "core/table.h"
#include "core/table_rows.h"
#include "geometry/body/body_figures.h"
#include "geometry/body/variants.h"
#include "geometry/mesh/mesh_file.h"
#include "studio/cli/body_parts.h"
#include "studio/cli/option_value.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

using core::format_number;

// ---- body compare A B ----

int compare_bodies(const std::string& a, const std::string& b, std::size_t triangles, Shell& shell) {
    const geometry::BodyShape first = geometry::read_shape(a), second = geometry::read_shape(b);
    const geometry::Comparison c = geometry::compare(first, second, triangles, shell.progress());
    shell.progress().report(1, "done");
    if (shell.json) {
        shell.print_json(c);
        return done;
    }
    if (c.equal) {
        shell.print(first.name + " and " + second.name + " are equal");
        return done;
    }
    for (const auto& d : c.differences) {
        shell.print(d.name + (d.unit.empty() || d.unit == "1" ? "" : " [" + d.unit + "]") + ": " + d.a + " -> " + d.b);
    }
    const auto change = [&](const char* name, double x, double y, double scale, const char* unit) {
        shell.print(std::string(name) + ": " + rounded(scale * x) + " -> " + rounded(scale * y) + " " + unit + " (" +
                    rounded(100 * (y / x - 1), 3) + " %)");
    };
    change("volume", c.volume_a, c.volume_b, 1e6, "cm^3");
    change("area", c.mass_a.area, c.mass_b.area, 1e4, "cm^2");
    change("base area", c.base_area_a, c.base_area_b, 1e4, "cm^2");
    shell.print("surfaces differ by at most " + rounded(1e3 * c.largest_distance, 4) + " mm, at (" +
                rounded(1e3 * c.where.x, 4) + ", " + rounded(1e3 * c.where.y, 4) + ", " + rounded(1e3 * c.where.z, 4) +
                ") mm");
    return done;
}

// ---- body sweep ----

// What was varied, as short as a sheet needs it.
std::string joined(const std::vector<std::string>& values) {
    std::string text;
    for (const std::string& value : values) {
        text += (text.empty() ? "" : ", ") + value;
    }
    return text.size() > 36 ? text.substr(0, 34) + "..." : text;
}

struct SweepArguments {
    std::string file, out;
    std::vector<std::string> vary, set, where;
    std::size_t triangles = 20000;
};

/// What the file varies, or the options instead.
geometry::VariantSet variants(const SweepArguments& given) {
    if (given.vary.empty() && given.set.empty()) {
        return geometry::read_variants(given.file);
    }
    if (given.vary.empty()) {
        throw core::UsageError("usage", "--set changes a shape that --vary varies", {},
                               "with [[vary]] in the file, change the file");
    }
    geometry::BodyShape shape = geometry::read_shape(given.file);
    for (const auto& text : given.set) {
        const auto [key, value] = name_and_value("--set", text);
        geometry::set_parameter(shape, key, value);
    }
    std::vector<geometry::Vary> varies;
    for (const auto& text : given.vary) {
        varies.push_back(geometry::vary_from(text));
    }
    return geometry::variants_of(shape, std::filesystem::path(given.file).stem().string(), varies);
}

/// Rows of the shapes that --where keeps.
std::vector<std::size_t> kept_rows(const SweepArguments& given, const core::Table& table) {
    std::string all;
    for (const auto& text : given.where) {
        all += (all.empty() ? "" : ",") + text;
    }
    return core::rows_within(table,
                             all.empty() ? std::vector<core::NamedRange>{} : core::ranges_of_columns(all, table));
}

nlohmann::json json_of(const geometry::VariantSet& set, const std::vector<geometry::MadeVariant>& made,
                       const std::vector<std::size_t>& kept) {
    nlohmann::json document{{"name", set.name}, {"keys", set.keys}, {"variants", nlohmann::json::array()}};
    for (const std::size_t i : kept) {
        const geometry::MadeVariant& m = made[i];
        nlohmann::json entry{{"name", m.variant->name},
                             {"values", m.variant->values},
                             {"same_as", m.variant->same_as},
                             {"refused", m.variant->refused}};
        if (!m.mesh.triangles.empty()) {
            entry["volume"] = m.mass.volume;
            entry["area"] = m.mass.area;
            entry["quality"] = m.certificate;
        }
        document["variants"].push_back(entry);
    }
    document["made"] = made.size();
    return document;
}

int sweep_shapes(const SweepArguments& given, Shell& shell) {
    const std::string& out = given.out;
    geometry::VariantSet set = variants(given);
    const std::vector<geometry::MadeVariant> made = geometry::make_variants(set, given.triangles, shell.progress());
    shell.progress().report(1, "done");
    const core::Table whole = geometry::table(set, made);
    const std::vector<std::size_t> kept = kept_rows(given, whole);
    const core::Table table = whole.selected(kept);
    std::vector<geometry::NamedBody> bodies;
    std::size_t refused = 0, equal = 0;
    for (const geometry::MadeVariant& m : made) {
        refused += m.variant->refused.empty() ? 0 : 1;
        equal += m.variant->same_as.empty() ? 0 : 1;
    }
    for (const std::size_t i : kept) {
        const geometry::MadeVariant& m = made[i];
        if (m.mesh.triangles.empty()) {
            continue;
        }
        bodies.push_back({m.variant->name + ": " + joined(m.variant->values), &m.mesh});
        if (!out.empty()) {
            core::write_file(std::filesystem::path(out) / (m.variant->name + ".toml"),
                             geometry::write_shape(m.variant->shape));
            geometry::write_mesh(m.mesh, std::filesystem::path(out) / (m.variant->name + ".stl"));
        }
    }
    if (!out.empty()) {
        core::write_csv(std::filesystem::path(out) / "shapes.csv", table);
        if (!bodies.empty()) {
            bodies.resize(std::min<std::size_t>(bodies.size(), 60));  // more than a sheet can show
            write_picture(geometry::sheet_figure(bodies, set.name), std::filesystem::path(out) / "sheet.png",
                          {1400, 1000, 1.5});
        }
    }
    if (shell.json) {
        shell.print_json(json_of(set, made, kept));
    } else if (out.empty()) {
        shell.print(core::write_csv(table));
    } else {
        const std::string within = given.where.empty() ? "" : ", " + std::to_string(kept.size()) + " within --where";
        shell.print(core::counted(made.size(), "shape") + ": " + std::to_string(made.size() - refused - equal) +
                    " made, " + std::to_string(equal) + " equal to an earlier one, " + std::to_string(refused) +
                    " refused" + within + "; " + out + "/shapes.csv, sheet.png");
    }
    return refused == made.size() || kept.empty() ? check_failed : done;
}

}  // namespace

void add_body_compare(CLI::App* body, Shell& shell, BodyActions& actions) {
    CLI::App* command = body->add_subcommand("compare", "what differs between two shapes, and what that does");
    struct Options {
        std::string a, b;
        std::size_t triangles = 6000;
    };
    auto o = std::make_shared<Options>();
    command->add_option("a", o->a, "SHAPE.toml")->required();
    command->add_option("b", o->b, "SHAPE.toml")->required();
    command->add_option("--triangles", o->triangles, "about how many triangles")->capture_default_str();
    command->footer(
        "Example:\n  underbody body compare cases/evie/shapes/rectangle.toml cases/evie/shapes/rectangle_bump2.toml");
    on(shell, actions, command, [o, &shell] { return compare_bodies(o->a, o->b, o->triangles, shell); });
}

void add_body_sweep(CLI::App* body, Shell& shell, BodyActions& actions) {
    CLI::App* command =
        body->add_subcommand("sweep", "all shapes of a file with [[vary]] lists or ranges and [[tie]]s");
    auto o = std::make_shared<SweepArguments>();
    command->add_option("file", o->file, "a SHAPE.toml with [[vary]], or any with --vary")->required();
    command->add_option("--vary", o->vary,
                        "PARAMETER=FROM:TO:COUNT or PARAMETER=VALUE,VALUE instead of the file's [[vary]]; several");
    command->add_option("--set", o->set, "PARAMETER=VALUE of all of them, with --vary; several");
    command->add_option("--where", o->where,
                        "COLUMN=LOW:HIGH: only shapes whose numbers lie within (exit code 4 when none does); several");
    command->add_option("--out", o->out, "folder for the shapes, their surfaces, shapes.csv and sheet.png");
    command->add_option("--triangles", o->triangles, "about how many triangles each")->capture_default_str();
    command->footer(
        "Example of a file: a shape, and below it\n"
        "  [[vary]]\n  key = \"protrusion.height\"\n  values = [\"1 mm\", \"2 mm\", \"3 mm\"]\n"
        "  [[vary]]\n  key = \"body.base_cut\"\n  from = 0.6\n  to = 0.8\n  count = 5\n"
        "  [[tie]]\n  key = \"protrusion.length\"\n  of = \"protrusion.height\"\n  factor = 5\n"
        "Then:\n  underbody body sweep bumps.toml --out bumps\n"
        "The same without a file of its own, of which those of a volume are wanted:\n"
        "  underbody body sweep hull.toml --vary protrusion.height=1mm:3mm:3 --vary body.base_cut=0.6:0.8:5 \\\n"
        "      --where volume=2200cm^3:2300cm^3");
    on(shell, actions, command, [o, &shell] { return sweep_shapes(*o, shell); });
}

}  // namespace underbody::studio
