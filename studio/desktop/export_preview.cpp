#include "studio/desktop/export_preview.h"

#include "core/file.h"
#include "core/text.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace fs = std::filesystem;

ExportPreview preview_of(const tables::ForceTable& table, const std::string& kind, const tables::ExportOptions& wanted,
                         core::Progress& progress) {
    const core::TemporaryFolder folder;
    std::string ending;
    for (const auto& one : tables::export_formats()) {
        ending = one.name == kind ? one.ending : ending;
    }
    const fs::path file = folder.path() / (wanted.name + ending);
    const auto result = tables::export_table(table, kind, file, wanted, progress);
    const std::string bytes = core::read_file(file);
    ExportPreview seen;
    if (result.error > 0) {
        seen.error = tables::export_difference_figure(table, kind, wanted, progress);
    }
    seen.facts = "grid ";
    for (std::size_t i = 0; i < result.grid.size(); ++i) {
        seen.facts += (i > 0 ? " x " : "") + QString::number(result.grid[i]);
    }
    seen.facts += QString(" points; file %1 bytes").arg(bytes.size());
    seen.facts +=
        result.error > 0
            ? QString("; within %1 %2 of the table").arg(qt(core::format_number(result.error, 3)), qt(table.unit()))
            : QString("; equal to the table");
    for (const auto& remark : result.remarks) {
        seen.facts += "\n" + qt(remark.message);
    }
    const bool text = bytes.find('\0') == std::string::npos;
    seen.text = text ? qt(bytes.substr(0, 200000)) : QString("(a binary file)");
    return seen;
}

/// Fitted again to its points, as it was.
tables::ForceTable refitted(const tables::ForceTable& known, const std::map<std::string, std::string>& range) {
    if (range.empty()) {
        return known;
    }
    tables::FitOptions fit;
    for (const auto& axis : known.axes()) {
        fit.range.named.emplace_back(axis.name, *tables::range_policy(range.at(axis.name)));
        fit.axes.push_back(axis.name);
    }
    fit.kind = known.kind().find("aussian") != std::string::npos  ? tables::FitOptions::Kind::gaussian_process
               : known.kind().find("spline") != std::string::npos ? tables::FitOptions::Kind::spline
                                                                  : tables::FitOptions::Kind::interpolation;
    return tables::ForceTable::fit(known.points(), known.quantity(), fit);
}

}  // namespace underbody::studio
