#include "cases/file_templates.h"

#include <cmath>
#include <utility>

#include "cases/study_format.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "geometry/body/shape_format.h"
#include "surrogates/dynamics/model/file_formats.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// A run for the template of a data set: a body that settles at 100 mm, damped, ten seconds at 20 per second.
std::string example_run() {
    std::string text = "# Example numbers: replace them with what was measured.\ntime [s], gap [mm], input_force [N]\n";
    for (int i = 0; i <= 200; ++i) {
        const double t = 0.05 * i;
        const double gap = 100 + 20 * std::exp(-0.3 * t) * std::cos(1.2 * t);
        text += core::format_number(t, 6) + ", " + core::format_number(gap, 6) + ", 0\n";
    }
    return text;
}

}  // namespace

const std::vector<const core::FileFormat*>& file_formats() {
    static const std::vector<const core::FileFormat*> all = {&geometry::shape_format(), &study_format(),
                                                             &dynamics::model_format(), &dynamics::dataset_format()};
    return all;
}

const core::FileFormat& file_format(const std::string& name) {
    std::vector<std::string> known;
    for (const core::FileFormat* format : file_formats()) {
        if (format->name == name) {
            return *format;
        }
        known.push_back(format->name);
    }
    throw core::UsageError("name", "there is no file format '" + name + "'", {}, core::did_you_mean(name, known));
}

std::vector<fs::path> write_template(const std::string& name, const fs::path& path) {
    const core::FileFormat& format = file_format(name);
    const std::string usual = core::lower_case(format.file);
    std::error_code ignored;
    const bool folder = path.empty() || fs::is_directory(path, ignored) || !path.has_filename();
    std::vector<std::pair<fs::path, std::string>> files;
    files.emplace_back(folder ? path / usual : path, core::template_text(format));
    if (name == "dataset") {
        files.emplace_back(files.front().first.parent_path() / "run-01.csv", example_run());
    }
    std::vector<fs::path> written;
    for (const auto& [file, text] : files) {
        if (fs::exists(fs::symlink_status(file, ignored))) {
            throw core::InputError("exists", "there is a file of this name already; nothing was written",
                                   {file.string(), {}, {}, {}}, "name another one");
        }
        written.push_back(file);
    }
    for (const auto& [file, text] : files) {
        core::write_file(file, text);
    }
    return written;
}

}  // namespace underbody::cases
