#include "core/html.h"

#include <algorithm>

#include "core/report_style.h"
#include "core/text.h"

namespace underbody::core {

namespace {

std::string anchor(std::size_t index) { return "s" + std::to_string(index); }

/// "0.27", "-1.2 ± 0.1", "3.2 %": what people want under each other by the right edge.
bool is_numeric(const std::string& cell) {
    const auto word = cell.substr(0, cell.find(' '));
    return cell.empty() || cell == "-" || parse_number(word).has_value();
}

std::string figure_of(const HtmlPage::Picture& picture) {
    return "<figure><img alt=\"" + escape_html(picture.alt.empty() ? picture.caption : picture.alt) +
           "\" src=\"data:image/png;base64," + base64(picture.png) + "\"><figcaption>" + escape_html(picture.caption) +
           "</figcaption></figure>\n";
}

}  // namespace

HtmlPage::HtmlPage(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void HtmlPage::section(const std::string& title) {
    body_ += "<h2 id=\"" + anchor(sections_.size()) + "\">" + escape_html(title) + "</h2>\n";
    sections_.push_back(title);
}

void HtmlPage::subsection(const std::string& title) { body_ += "<h3>" + escape_html(title) + "</h3>\n"; }

void HtmlPage::paragraph(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }

void HtmlPage::warning(const std::string& text) { body_ += "<p class=\"warning\">" + escape_html(text) + "</p>\n"; }

void HtmlPage::facts(const std::vector<Fact>& facts) {
    // No row with one alone: six are two rows of three.
    const std::size_t count = facts.size();
    const std::size_t columns = count <= 5 ? count : count % 4 == 0 ? 4 : count % 3 == 0 ? 3 : count % 4 >= 2 ? 4 : 3;
    body_ += "<div class=\"facts" + (count > 5 ? " of" + std::to_string(columns) : std::string()) + "\">";
    for (const auto& fact : facts) {
        body_ += "<div class=\"fact\"><span class=\"value\">" + escape_html(fact.value) +
                 "</span><span class=\"label\">" + escape_html(fact.label) + "</span></div>";
    }
    body_ += "</div>\n";
}

void HtmlPage::list(const std::vector<std::string>& items) {
    body_ += "<ul>";
    for (const auto& item : items) {
        body_ += "<li>" + escape_html(item) + "</li>";
    }
    body_ += "</ul>\n";
}

void HtmlPage::table_body(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                          const std::string& caption) {
    std::vector<bool> numeric(header.size(), !rows.empty());
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < std::min(row.size(), numeric.size()); ++i) {
            numeric[i] = numeric[i] && is_numeric(row[i]);
        }
    }
    body_ += "<div class=\"table-wrap\"><table>";
    if (!caption.empty()) {
        body_ += "<caption>" + escape_html(caption) + "</caption>";
    }
    body_ += "<thead><tr>";
    for (std::size_t i = 0; i < header.size(); ++i) {
        body_ += std::string("<th") + (numeric[i] ? " class=\"num\"" : "") + ">" + escape_html(header[i]) + "</th>";
    }
    body_ += "</tr></thead><tbody>\n";
    for (const auto& row : rows) {
        body_ += "<tr>";
        for (std::size_t i = 0; i < row.size(); ++i) {
            body_ += std::string("<td") + (i < numeric.size() && numeric[i] ? " class=\"num\"" : "") + ">" +
                     escape_html(row[i]) + "</td>";
        }
        body_ += "</tr>\n";
    }
    body_ += "</tbody></table></div>\n";
}

void HtmlPage::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                     const std::string& caption) {
    table_body(header, rows, caption);
}

void HtmlPage::folded_table(const std::string& title, const std::vector<std::string>& header,
                            const std::vector<std::vector<std::string>>& rows) {
    body_ += "<details><summary>" + escape_html(title) + "</summary>\n";
    table_body(header, rows, {});
    body_ += "</details>\n";
}

void HtmlPage::picture(const Picture& picture) { body_ += figure_of(picture); }

void HtmlPage::pictures(const std::vector<Picture>& pictures) {
    body_ += "<div class=\"figures\">\n";
    for (const auto& picture : pictures) {
        body_ += figure_of(picture);
    }
    body_ += "</div>\n";
}

void HtmlPage::link(const std::string& target, const std::string& text) {
    body_ += "<p><a href=\"" + escape_html(target) + "\">" + escape_html(text) + "</a></p>\n";
}

std::string HtmlPage::text() const {
    std::string page =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"generator\" content=\"Underbody\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>" +
        escape_html(title_) + "</title>\n<style>\n" + std::string(report_style) +
        "</style></head>\n<body><main>\n<header><h1>" + escape_html(title_) + "</h1><p class=\"subtitle\">" +
        escape_html(subtitle_) + "</p></header>\n";
    page += "<nav class=\"contents\"><ol>";
    for (std::size_t i = 0; i < sections_.size(); ++i) {
        page += "<li><a href=\"#" + anchor(i) + "\">" + escape_html(sections_[i]) + "</a></li>";
    }
    page += "</ol></nav>\n";
    return page + body_ + "</main></body></html>\n";
}

}  // namespace underbody::core
