% SPDX-License-Identifier: BSD-3-Clause
% Reads a montecarta result file (analysis/FORMAT.md) into nested structs, axes turned round:
%   s = load_results('out.h5'); s.cells.ekf_slam.pose_mean(component, time, run)
% Tested with Octave. MATLAB reads HDF5 by h5info and h5read, which Octave does not have: that
% branch uses nothing else that Octave lacks, but has not been run.
function s = load_results(path)
  if exist('OCTAVE_VERSION', 'builtin')
    s = load('-hdf5', path);
  else
    s = read_group(path, h5info(path));
  end
end

function s = read_group(path, group)
  s = struct();
  for k = 1:numel(group.Datasets)
    name = group.Datasets(k).Name;
    s.(name) = h5read(path, [group.Name, '/', name]);
  end
  for k = 1:numel(group.Groups)
    name = group.Groups(k).Name;
    s.(name(max(strfind(name, '/')) + 1:end)) = read_group(path, group.Groups(k));
  end
end
