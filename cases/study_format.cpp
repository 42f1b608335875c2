#include "cases/study_format.h"

#include "cases/design_spec.h"
#include "cases/study_spec.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

namespace study_keys {

using core::FileKey;
using core::FileTable;

std::string loads_in_words() {
    std::string words;
    for (const auto& quantity : core::quantity_names()) {
        if (quantity.name.ends_with("_force") || quantity.name.ends_with("_moment")) {
            words += (words.empty() ? "" : " | ") + quantity.name;
        }
    }
    return words;
}

FileKey name_key(const std::string& example) {
    return {"name", "text", example, "", "its name in the report and in file names"};
}

/// `where` of a table: which cases it takes.
FileTable selection(const std::string& path) {
    return {path + ".where",
            "the cases that it takes: those that have all of these conditions; left out, all cases",
            {{"*", "the unit of the quantity, or text", "gap = \"5 mm\"", "", "a condition of the cases by its name"}},
            false,
            "where = { variant = \"ellipse\", pitch = 0 }"};
}

FileTable conditions(const std::string& path, const std::string& meaning, const std::string& line) {
    return {path,
            meaning,
            {{"*", "the unit of the quantity, or text", "speed = \"0.5 m/s\"", "",
              "a quantity by its name, or a word of your own (mesh = \"fine\")"}},
            false,
            line};
}

FileTable top() {
    return {"",
            "What stands before the first table",
            {{"title", "text", "\"Lift over a moving ground\"", "", "heading of the report"},
             {"summary", "text", "\"What was asked and why.\"", "none", "first paragraph of the report"},
             {"origin", "text", "\"OpenFOAM 1912, k-omega SST\"", "none",
              "where the data come from, printed in the report"},
             {"thesis", "true or false", "true", "false", "adds the published estimator study to the report"},
             {"thesis_dynamics", "true or false", "true", "false",
              "adds the published studies of springs, sizes and jets to the report"}},
            true};
}

FileTable frame() {
    const std::string directions = "+x | -x | +y | -y | +z | -z";
    return {
        "frame",
        "how the axes of the CFD files lie",
        {{"forward", directions, "\"+x\"", "+x", "direction in which the body moves"},
         {"up", directions, "\"+z\"", "+z", "direction away from the ground"},
         {"symmetry", "text", "\"y\"", "none: whole models",
          "the files hold half a body; its plane of symmetry is normal to this axis, with its place if not 0: y=0.1"},
         {"moments_about", "base_centre | list of m", "\"base_centre\"", "base_centre",
          "point of the moments: the centre of the base, or x, y, z in the files' axes"}}};
}

FileTable reference() {
    return {"reference",
            "reference values of the coefficients",
            {{"length", "m", "\"203.2 mm\"", "none", "length of the body"},
             {"width", "m", "\"152 mm\"", "none", "width of the body"},
             {"height", "m", "\"145 mm\"", "none", "height of the body"},
             {"density", "kg/m^3", "\"998 kg/m^3\"", "998",
              "density of the water, of cases whose conditions state none of their own"},
             {"speed", "m/s", "\"0.5 m/s\"", "the speed of each case",
              "speed of the coefficients of cases whose conditions state none, and of [sweep]"}}};
}

std::vector<FileTable> inputs() {
    return {
        {"case[]",
         "CFD files, each one a case",
         {{"files", "text", "\"fields/{variant}-h{gap:mm}-p{pitch:deg}.csv\"", "",
           "pattern of the file names: {word} takes a word, {quantity:unit} a number with its unit, * anything"},
          {"zones", "list of texts", "[\"hull*\", \"base\"]", "all walls", "patterns of the zones that are the body"},
          {"length_unit", "text", "\"mm\"", "none", "unit of the coordinates, where the files do not say it"},
          {"mean", "true or false", "false", "false",
           "the files are instants of runs in time ({time:s} in their names): those that differ in their time alone "
           "count as their mean, with an error that knows their correlation"},
          {"design_points", "file", "\"points.csv\"", "none",
           "Workbench's table of design points: the conditions of the files, whose pattern says {design_point}"}}},
        {"case[].units",
         "units of variables that the files do not say",
         {{"*", "text", "Pressure = \"Pa\"", "", "a variable by its name in the files"}},
         false,
         "units = { Pressure = \"Pa\" }"},
        {"case[].parameters",
         "which quantity a parameter of that table is, where its name does not say it",
         {{"*", "text", "P1 = \"gap [mm]\"", "by its name",
           "a condition, with a unit that the table does not say; \"\": none"}},
         false,
         "parameters = { P1 = \"gap [mm]\" }"},
        conditions("case[].conditions", "conditions that the file names do not say",
                   "conditions = { mesh = \"medium\", speed = \"0.5 m/s\" }"),
        {"body[]",
         "a shape, drawn in the report and used by [sweep]",
         {name_key("\"ellipse\""),
          {"shape", "file", "\"shapes/ellipse.toml\"", "", "SHAPE.toml, relative to this file"}}}};
}

std::vector<FileTable> sweep() {
    const SweepSpec usual;
    std::vector<FileTable> tables = {
        {"sweep",
         "cases to be computed: every body at every gap, pitch and speed",
         {{"gap", "m or list of m", "[\"2 mm\", \"5 mm\"]", "", "gaps"},
          {"bodies", "list of texts", "[\"ellipse\"]", "all [[body]]", "names of [[body]]"},
          {"pitch", "rad or list of rad", "[\"0 deg\"]", "0", "pitch angles, positive nose up"},
          {"speed", "m/s or list of m/s", "\"0.5 m/s\"", "reference.speed", "speeds"},
          {"folder", "text", "\"runs\"", "runs", "folder of the cases, relative to this file"},
          {"kinematic_viscosity", "m^2/s", "\"1.0e-6 m^2/s\"",
           core::format_number(usual.kinematic_viscosity) + " m^2/s", "of the water"}}},
        {"sweep.slurm",
         "what Slurm is asked for; options of the command line count over it",
         {{"partition", "text", "\"short\"", "the site's", "partition, as sbatch takes it"},
          {"time", "text", "\"02:00:00\"", "the site's", "limit of a case"},
          {"memory", "text", "\"4G\"", "the site's", "memory of a case"},
          {"account", "text", "\"ground-effect\"", "the site's", "account, as sbatch takes it"},
          {"throttle", "whole number", "8", "0 (no limit)", "cases at a time"},
          {"max_array", "whole number", "1000", "0 (what scontrol says, else 1000)",
           "cases in one job array; more make several"},
          {"cores", "whole number", "8", "1", "cores of a case: decomposed, run by MPI, put together again"},
          {"retries", "whole number", "2", "0", "how often a case is tried again whose solver was ended or failed"},
          {"run_study", "true or false", "true", "false", "a job more that runs the study when the arrays have ended"},
          {"options", "list of texts", "[\"--nice=100\"]", "none", "further options of sbatch"}}},
        conditions("sweep.conditions", "further conditions of these cases", "conditions = { mesh = \"coarse\" }")};
    const auto of_jet = jet_axis_keys(), of_mesh = case_mesh_keys(usual.mesh.density);
    tables.front().keys.insert(tables.front().keys.end(), of_jet.begin(), of_jet.end());
    tables.front().keys.insert(tables.front().keys.end(), of_mesh.begin(), of_mesh.end());
    return tables;
}

std::vector<FileTable> results() {
    const RegionSpec region;
    return {
        {"mesh_uncertainty[]",
         "one set point computed on several meshes: the error of the discretisation",
         {name_key("\"5 mm\""),
          {"column", "text", "\"mesh\"", MeshSpec{}.column, "the condition that tells the meshes apart"},
          {"quantities", "list of texts", "[\"lift_force\"]", "", "loads that are judged"}}},
        selection("mesh_uncertainty[]"),
        {"mesh_uncertainty[].cells",
         "number of cells of each mesh, two at least",
         {{"*", "1", "fine = 374400", "", "word of the mesh and its number of cells"}},
         true,
         "cells = { coarse = 57280, medium = 138544, fine = 374400 }"},
        {"table[]",
         "a force table made of cases",
         {name_key("\"lift\""),
          {"quantity", loads_in_words(), "\"lift_force\"", "", "the load"},
          {"axes", "list of texts", "[\"gap\"]", "", "conditions that are its axes"},
          {"shape", "file", "\"shapes/evie.toml\"", "none: of cases",
           "SHAPE.toml of the family of [design]: its loads by the surrogates, no cases of its own; where says the "
           "conditions that are no axis"},
          {"fit", "automatic | interpolation | gaussian_process | spline", "\"automatic\"", "automatic",
           "how values between the points are found, here, in its exports and in maps"},
          {"speed_exponent", "1", "2", "2",
           "of the force in a [[region]] where all its cases have one speed: (speed / that speed)^exponent"},
          {"relative_sigma", "1", "0.02", "0", "standard deviation of each value as a share of it, added in squares"},
          {"mesh_uncertainty", "text", "\"5 mm\"", "none",
           "name of the [[mesh_uncertainty]] whose error all points carry"},
          {"net_weight", "N", "\"0.30 N\"", "none", "weight less buoyancy: equilibria are found for it"},
          {"virtual_mass", "kg", "\"3.954 kg\"", "0", "mass and added mass: frequency of the equilibria"},
          {"exports", "list of texts", "[\"c\", \"csv\"]", "none",
           "formats for controllers: c, csv, json, mat, jsbsim, fmu"}}},
        selection("table[]"),
        {"compare[]",
         "tables over one axis, laid over each other",
         {name_key("\"lift of the bodies\""), {"tables", "list of texts", "[\"lift\"]", "", "names of [[table]]"}}},
        {"region[]",
         "map of the starts from which the motion comes back",
         {name_key("\"glide\""),
          {"model", "file", "\"model.toml\"", "", "model.toml, relative to this file"},
          {"forces", "list of texts", "[\"lift\"]", "none",
           "[[table]]s of this study that are added to the model, with speed squared"},
          {"axes", "list of texts", "[\"gap=1mm:100mm\", \"heave_velocity=-0.02:0.02\"]", "",
           "the two axes of the map and their ranges; also as one text with a comma between them"},
          {"for", "s", "\"60 s\"", core::format_number(region.duration) + " s", "how long each start is followed"},
          {"columns", "whole number", "400", std::to_string(region.columns), "starts along the first axis"},
          {"rows", "whole number", "400", std::to_string(region.rows), "starts along the second axis"}}}};
}

std::vector<FileTable> checks() {
    return {{"verify[]",
             "our loads against the solver's own",
             {name_key("\"forces\""),
              {"table", "file", "\"forces.csv\"", "", "table of the solver's forces, one row a case"},
              {"quantities", "list of texts", "[\"lift_force\"]", "", "loads that are compared"},
              {"tolerance", "1", "0.01", core::format_number(VerifySpec{}.tolerance),
               "largest difference, as a share of the size of the force"}}},
            selection("verify[]"),
            {"measurement[]",
             "measured runs against a model",
             {name_key("\"heave test\""),
              {"model", "file", "\"heave/model.toml\"", "", "model.toml, relative to this file"},
              {"data", "file", "\"heave\"", "", "folder with dataset.toml"},
              {"discover", "true or false", "true", "false", "also find the effect that the model lacks"}}},
            {"picture[]",
             "pictures of some cases",
             {name_key("\"level\""),
              {"views", "list of texts", "[\"pressure-underbody\"]", "all views of the field", "names of views"},
              {"range", "list of Pa", "[\"-120 Pa\", \"120 Pa\"]", "the range of each picture",
               "of the colours of pressure"}}},
            selection("picture[]")};
}

}  // namespace study_keys

const core::FileFormat& study_format() {
    static const core::FileFormat format = [] {
        core::FileFormat made{"study", "study.toml", "a folder of cases that becomes one report", {}};
        made.tables = {study_keys::top(), study_keys::frame(), study_keys::reference()};
        for (const auto& group : {study_keys::inputs(), study_keys::sweep(), design_tables(), study_keys::results(),
                                  study_keys::checks()}) {
            made.tables.insert(made.tables.end(), group.begin(), group.end());
        }
        return made;
    }();
    return format;
}

}  // namespace underbody::cases
