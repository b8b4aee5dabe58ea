#pragma once
// In: the name of a sequence of a public dataset. Out: what to download, and where the sequence lies in it.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

/// One row a dataset, or a part of one. $1, $2, ... stand for the groups of `pattern`.
struct PublicDataset {
  std::string_view title;
  std::string_view examples;  ///< "": a part of the dataset in the row above
  std::string_view pattern;   ///< regular expression of all names
  std::string_view server;    ///< "": known to those only who agreed to the terms, see `access`
  std::array<std::string_view, 2> archives;  ///< below the server; unpacked into one folder; "": none
  std::string_view inside;    ///< the folder in the archives; "" if they have none of their own
  std::string_view folder;    ///< what `inside` becomes, below the output
  std::string_view sequence;  ///< in `folder`, perhaps as an archive of its own; "" if it is `folder` itself
  std::string_view evidence;  ///< a file of every sequence
  std::string_view licence;
  std::string_view access = "";           ///< how to come by the server's address
  std::string_view server_variable = "";  ///< the environment variable that has it
};

/// The datasets that can be downloaded.
std::span<const PublicDataset> public_datasets();

/// The row of a dataset with a name filled in; fields as in PublicDataset.
struct FetchPlan {
  std::string server;
  std::vector<std::string> archives;
  std::string inside, folder, sequence, evidence, licence, access, server_variable;
};

/// Throws UsageError for names of no dataset.
FetchPlan plan_fetch(const std::string& name);

}  // namespace kinloop
