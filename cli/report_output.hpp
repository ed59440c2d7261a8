// What the verbs that make reports share: reading folders, and folders that are whole or absent.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/src/html_report.hpp"

namespace brickbench {

Expected<std::vector<ReportSource>> read_sources(const std::vector<std::string>& folders);

// Writes the files into a new folder that appears whole or not at all.
Expected<void> write_folder(const std::string& out, const std::vector<OutputFile>& files);

struct WrittenReport {
  std::size_t pdfs = 0;
  std::string no_pdf_reason;  // empty if all figures became PDF, or none was wanted
};

// write_folder(), and with gnuplot on the PATH figures/<id>.pdf.
Expected<WrittenReport> write_report(const std::string& out, std::vector<OutputFile> files,
                                     const std::vector<Figure>& figures, bool want_pdf);

// The same bytes for the same input: the date of creation of a PDF becomes the start of 1970. Other
// files stay as they are.
void undate_pdf(const std::filesystem::path& pdf);

// A program on the PATH; "" if there is none of these names.
std::string program_on_path(const std::vector<std::string>& names);

}  // namespace brickbench
