% SPDX-License-Identifier: BSD-3-Clause
function montecarta_filter(filter)
% Runs a filter in Octave as a cell of a montecarta study. Copy this file beside yours.
%
% filter  struct of functions, with lengths in m, angles in rad, times in s:
%   belief = filter.start(pose, settings, run, seed)
%     starts a run at pose [x; y; heading], which is known exactly; settings has the vehicle and the
%     noise that the filter should assume; seed is for a random generator
%   belief = filter.predict(belief, speed, steer, duration)
%     vehicles other than cars have the controls that settings.controls names, then duration
%   belief = filter.update(belief, detections)
%     detections is n x 3 with rows [range bearing identity]; identity -1: false alarm, or unknown
%   [mean, covariance] = filter.estimate(belief)
%   report = filter.report(belief)
%     optional; struct with any of log_likelihood, nis, nis_dof, ess, map_size of the last update
%   rows = filter.map(belief)
%     optional; rows [identity x y xx xy yy]
%
% The belief is the only state between calls, so a start does not depend on earlier runs.
% Print to standard error only, fprintf(stderr, ...): standard output is reserved for the answers.
% montecarta shows only its last line, as the reason if the program ends. To see all of it, send it
% to a file: command="sh -c 'octave-cli --no-history --eval mine 2>>log.txt'".
  if ~isfield(filter, 'report')
    filter.report = @(belief) struct();
  end
  if ~isfield(filter, 'map')
    filter.map = @(belief) zeros(0, 6);
  end
  belief = [];
  while true
    try
      line = input('', 's');  % fgetl() would wait for the next line
    catch
      return  % the input has ended
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

% The numbers of a member as a column. jsondecode() does not round all of them correctly.
function numbers = exact(line, name)
  text = regexp(line, ['"' name '":([^"}]*)'], 'tokens', 'once'){1};
  text(text == '[' | text == ']' | text == ',') = ' ';
  numbers = sscanf(text, '%f');
end

% Text of numbers that reads back as the same bits. NaN becomes null.
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
