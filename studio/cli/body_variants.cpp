// underbody body compare, underbody body sweep.
#include <memory>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "geometry/body/body_figures.h"
#include "geometry/body/variants.h"
#include "geometry/mesh/mesh_file.h"
#include "studio/cli/body_parts.h"
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

int sweep_shapes(const std::string& file, const std::string& out, std::size_t triangles, Shell& shell) {
    geometry::VariantSet set = geometry::read_variants(file);
    const std::vector<geometry::MadeVariant> made = geometry::make_variants(set, triangles, shell.progress());
    shell.progress().report(1, "done");
    const core::Table table = geometry::table(set, made);
    std::vector<geometry::NamedBody> bodies;
    std::size_t refused = 0, equal = 0;
    for (const geometry::MadeVariant& m : made) {
        refused += m.variant->refused.empty() ? 0 : 1;
        equal += m.variant->same_as.empty() ? 0 : 1;
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
        nlohmann::json document{{"name", set.name}, {"keys", set.keys}, {"variants", nlohmann::json::array()}};
        for (const geometry::MadeVariant& m : made) {
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
        shell.print_json(document);
    } else if (out.empty()) {
        shell.print(core::write_csv(table));
    } else {
        shell.print(std::to_string(made.size()) + " shapes: " + std::to_string(made.size() - refused - equal) +
                    " made, " + std::to_string(equal) + " equal to an earlier one, " + std::to_string(refused) +
                    " refused; " + out + "/shapes.csv, sheet.png");
    }
    return refused == made.size() ? check_failed : done;
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
    struct Options {
        std::string file, out;
        std::size_t triangles = 20000;
    };
    auto o = std::make_shared<Options>();
    command->add_option("file", o->file, "a SHAPE.toml with [[vary]]")->required();
    command->add_option("--out", o->out, "folder for the shapes, their surfaces, shapes.csv and sheet.png");
    command->add_option("--triangles", o->triangles, "about how many triangles each")->capture_default_str();
    command->footer(
        "Example of a file: a shape, and below it\n"
        "  [[vary]]\n  key = \"protrusion.height\"\n  values = [\"1 mm\", \"2 mm\", \"3 mm\"]\n"
        "  [[vary]]\n  key = \"body.base_cut\"\n  from = 0.6\n  to = 0.8\n  count = 5\n"
        "  [[tie]]\n  key = \"protrusion.length\"\n  of = \"protrusion.height\"\n  factor = 5\n"
        "Then:\n  underbody body sweep bumps.toml --out bumps");
    on(shell, actions, command, [o, &shell] { return sweep_shapes(o->file, o->out, o->triangles, shell); });
}

}  // namespace underbody::studio
