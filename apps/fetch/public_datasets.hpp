#pragma once
// In: the name of a sequence of a public dataset. Out: what to download, and where the sequence lies in it.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

/// One row a dataset. $1, $2, ... stand for the groups of `pattern`.
struct PublicDataset {
  std::string_view title;
  std::string_view examples;
  std::string_view pattern;  ///< regular expression of all names
  std::string_view server;
  std::array<std::string_view, 2> archives;  ///< below the server; unpacked into one folder; "": none
  std::string_view inside;    ///< the folder in the archives; "" if they have none of their own
  std::string_view folder;    ///< what `inside` becomes, below the output
  std::string_view sequence;  ///< in `folder`, perhaps as SEQUENCE.zip; "" if it is `folder` itself
  std::string_view evidence;  ///< a file of every sequence
  std::string_view licence;
};

/// The datasets that can be downloaded without an account.
std::span<const PublicDataset> public_datasets();

/// A dataset that is given to those who ask for it.
struct RequestedDataset {
  std::string_view prefix;
  std::string_view title;
  std::string_view remedy;
};

std::span<const RequestedDataset> requested_datasets();

/// The row of a dataset with a name filled in; fields as in PublicDataset.
struct FetchPlan {
  std::string server;
  std::vector<std::string> archives;
  std::string inside, folder, sequence, evidence, licence;
};

/// Throws UsageError for names of no dataset, and for datasets that must be asked for, with what to do.
FetchPlan plan_fetch(const std::string& name);

}  // namespace kinloop
