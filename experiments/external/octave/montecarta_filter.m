% SPDX-License-Identifier: BSD-3-Clause
function montecarta_filter(filter)
% A filter in Octave as a cell of a montecarta study; copy this file beside yours.
%
% filter  struct of functions; lengths in m, angles in rad, time in s:
%   belief = filter.start(pose, settings, run, seed)
%     a run begins at pose [x; y; heading], known exactly; settings: vehicle and noise as believed;
%     seed: for a random generator, the same for the same study and run
%   belief = filter.predict(belief, speed, steer, duration)
%     instead of speed and steer what settings.controls names, where the vehicle is no car
%   belief = filter.update(belief, detections)
%     detections: n x 3, rows [range bearing identity]; identity -1: a false alarm, or unknown
%   [mean, covariance] = filter.estimate(belief)
%   report = filter.report(belief)  may be left out: struct of log_likelihood, nis, nis_dof, ess,
%     map_size, or some of them, of the last update
%   rows = filter.map(belief)       may be left out: rows [identity x y xx xy yy]
%
% Since a belief is all that goes from call to call, nothing of an earlier run is left at start.
% Print to standard error only, fprintf(stderr, ...): standard output belongs to the answers.
  if ~isfield(filter, 'report')
    filter.report = @(belief) struct();
  end
  if ~isfield(filter, 'map')
    filter.map = @(belief) zeros(0, 6);
  end
  belief = [];
  while true
    try
      line = input('', 's');  % fgetl() would wait for the line after it
    catch
      return  % there are no more
    end
    message = jsondecode(line);
    [belief, members] = answer(filter, belief, message, line);
    printf('{"id":%d%s}\n', message.id, members);
    fflush(stdout);
  end
end

function [belief, members] = answer(filter, belief, message, line)
  members = '';
  if strcmp(message.type, 'start')
    settings = message.settings;
    for name = fieldnames(settings)'
      if isnumeric(settings.(name{1}))
        settings.(name{1}) = exact(line, name{1});
      end
    end
    belief = filter.start(exact(line, 'start'), settings, message.run, message.seed);
    return
  end
  if strcmp(message.type, 'map')
    members = [',"map":' rows_text(filter.map(belief))];
    return
  end
  for u = reshape(exact(line, 'controls'), max(columns(message.controls), 1), [])
    u = num2cell(u);
    belief = filter.predict(belief, u{:});
  end
  if strcmp(message.type, 'scan')
    belief = filter.update(belief, reshape(exact(line, 'detections'), 3, [])');
    report = filter.report(belief);
    for name = fieldnames(report)'
      members = [members sprintf(',"%s":%s', name{1}, number_text(report.(name{1})))];
    end
  end
  [mean, covariance] = filter.estimate(belief);
  members = [members ',"mean":' row_text(mean) ',"covariance":' rows_text(covariance)];
end

% The numbers of a member, one below the other; jsondecode() rounds some of them wrongly.
function numbers = exact(line, name)
  text = regexp(line, ['"' name '":([^"}]*)'], 'tokens', 'once'){1};
  text(text == '[' | text == ']' | text == ',') = ' ';
  numbers = sscanf(text, '%f');
end

% Numbers that read back as the same bits; one that is none is null.
function text = number_text(numbers)
  text = strrep(sprintf('%.17g,', numbers)(1:end-1), 'NaN', 'null');
  text = strrep(text, 'Inf', '1e999');
end

function text = row_text(row)
  text = ['[' number_text(row) ']'];
end

function text = rows_text(rows)
  texts = cell(1, size(rows, 1));
  for i = 1:size(rows, 1)
    texts{i} = row_text(rows(i, :));
  end
  text = ['[' strjoin(texts, ',') ']'];
end
