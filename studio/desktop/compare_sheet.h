// What Compare shows, on one sheet: pictures with their cases, array, range and units, and the forces. As PNG, PDF, SVG
// and for the clipboard; always on white.
#pragma once

#include <QImage>
#include <QString>
#include <QStringList>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

namespace underbody::studio {

struct Sheet {
    QString title;  ///< "pressure (Pa), -120 to 110"
    QString about;  ///< study, camera, zones
    std::vector<std::pair<QString, QImage>> cells;
    std::vector<QStringList> rows;               ///< of the table of forces; the first: its titles
    std::set<std::pair<std::size_t, int>> bold;  ///< row and column of the table
};

/// How many columns of cells `count` pictures are laid out in.
int sheet_columns(std::size_t count);

QImage draw_sheet(const Sheet& sheet);
/// By the ending: .png (with the title in its metadata), .pdf (text as text), .svg (likewise).
/// Throws core::UsageError for another one, core::SystemError when it cannot be written.
void write_sheet(const Sheet& sheet, const std::filesystem::path& path);

}  // namespace underbody::studio
