#pragma once
// JSON files of datasets, with errors that name the file and the key.

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace kinloop {

/// Throws InputError naming the file, and the place if it is not JSON.
nlohmann::json read_json(const std::filesystem::path& file);

/// Returns the number at `key`. Throws InputError naming file and key unless there is one.
double number_at(const nlohmann::json& object, const std::string& key, const std::filesystem::path& file);

/// Returns the list of at least `least` numbers at `key`. Throws InputError naming file and key.
std::vector<double> numbers_at(const nlohmann::json& object, const std::string& key, size_t least,
                               const std::filesystem::path& file);

}  // namespace kinloop
